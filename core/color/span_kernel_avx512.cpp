#include "core/color/span_kernel.h"

namespace touchline {

SpanKernel avx512_kernel(PixelFormat) { return nullptr; }

}  // namespace touchline
