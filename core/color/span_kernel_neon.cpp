#include "core/color/span_kernel.h"

namespace touchline {

SpanKernel neon_kernel(PixelFormat) { return nullptr; }

}  // namespace touchline
