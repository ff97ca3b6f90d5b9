#include "core/subpixel/fit_kernel.h"

#include <algorithm>

#include "core/subpixel/simd/prerequisites.h"

#define TOUCHLINE_SIMD portable
#include "core/subpixel/simd/kernel_functions.h"
#undef TOUCHLINE_SIMD

namespace touchline {

const FitKernel& portable_fit_kernel() {
  using namespace portable;
  static constexpr FitKernel kKernel{sample_top,  sample_patch,       accumulate_edge,
                                     sample_ball, accumulate_shading, accumulate_outline};
  return kKernel;
}

const FitKernel& fit_kernel(KernelChoice choice) {
  const FitKernel* avx2 = choice == KernelChoice::kPortable ? nullptr : avx2_fit_kernel();
  return avx2 != nullptr ? *avx2 : portable_fit_kernel();
}

int sampling_stride(float reach_px, float all_px) { return 1 + static_cast<int>(std::min(reach_px, 4000.0f) / all_px); }

}  // namespace touchline
