#include "core/color/span_kernel.h"

namespace touchline {

SpanKernel find_span_kernel(PixelFormat format, KernelChoice& choice) {
  choice = resolve(choice);
  if (!cpu_supports(choice)) return nullptr;
  switch (choice) {
#define TOUCHLINE_SET(family, set, word, features, span_kernel, ...) \
  TOUCHLINE_ON_##family(case KernelChoice::set : return span_kernel(format);)
    TOUCHLINE_KERNEL_SETS(TOUCHLINE_SET)
#undef TOUCHLINE_SET
    default:
      return nullptr;
  }
}

}  // namespace touchline
