#include "core/color/span_kernel.h"

namespace touchline {
namespace {

SpanKernel kernel_of(PixelFormat format, KernelChoice choice) {
  switch (choice) {
    case KernelChoice::kPortable:
      return scalar_kernel(format);
    case KernelChoice::kAvx2:
      return avx2_kernel(format);
    case KernelChoice::kAvx512:
      return avx512_kernel(format);
    case KernelChoice::kNeon:
      return neon_kernel(format);
    case KernelChoice::kFastest:
      break;
  }
  return nullptr;
}

}  // namespace

SpanKernel find_kernel(PixelFormat format, KernelChoice& choice) {
  if (choice != KernelChoice::kFastest) return kernel_of(format, choice);
  for (const KernelChoice better :
       {KernelChoice::kAvx512, KernelChoice::kAvx2, KernelChoice::kNeon, KernelChoice::kPortable}) {
    choice = better;
    if (const SpanKernel kernel = kernel_of(format, better)) return kernel;
  }
  return nullptr;
}

}  // namespace touchline
