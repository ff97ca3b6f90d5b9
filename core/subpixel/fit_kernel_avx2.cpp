#include "core/subpixel/fit_kernel.h"

#if defined(__x86_64__)

#include "core/subpixel/simd/prerequisites.h"

// The build's flags select no AVX2, because the program also runs on processors without it.
#if defined(__clang__)
#pragma clang attribute push(__attribute__((target("avx2"))), apply_to = function)
#else
#pragma GCC push_options
#pragma GCC target("avx2")
#endif

#define TOUCHLINE_SIMD avx2
#define TOUCHLINE_SIMD_AVX2
#include "core/subpixel/simd/kernel_functions.h"
#undef TOUCHLINE_SIMD_AVX2
#undef TOUCHLINE_SIMD

#if defined(__clang__)
#pragma clang attribute pop
#else
#pragma GCC pop_options
#endif

namespace touchline {

const FitKernel& avx2_fit_kernel() {
  using namespace avx2;
  static constexpr FitKernel kKernel{sample_top, sample_patch,       accumulate_edge,   sample_ball,
                                     move_ball,  accumulate_shading, accumulate_outline};
  return kKernel;
}

}  // namespace touchline

#endif
