#include "core/subpixel/fit_kernel.h"

#include <algorithm>

#include "core/subpixel/simd/prerequisites.h"

#define TOUCHLINE_SIMD portable
#include "core/subpixel/simd/kernel_functions.h"
#undef TOUCHLINE_SIMD

namespace touchline {

const FitKernel& portable_fit_kernel() {
  using namespace portable;
  static constexpr FitKernel kKernel{sample_top, sample_patch,       accumulate_edge,   sample_ball,
                                     move_ball,  accumulate_shading, accumulate_outline};
  return kKernel;
}

const FitKernel& fit_kernel(KernelChoice choice) {
  const KernelChoice chosen = resolve(choice);
  if (!cpu_supports(chosen)) return portable_fit_kernel();
  switch (chosen) {
#define TOUCHLINE_SET(family, set, word, features, span_kernel, kernel) \
  TOUCHLINE_ON_##family(case KernelChoice::set : return kernel();)
    TOUCHLINE_KERNEL_SETS(TOUCHLINE_SET)  // NOLINT(bugprone-branch-clone): sets may share a function
#undef TOUCHLINE_SET
    default:
      return portable_fit_kernel();
  }
}

int sampling_stride(float reach_px, float all_px) { return 1 + static_cast<int>(std::min(reach_px, 4000.0f) / all_px); }

}  // namespace touchline
