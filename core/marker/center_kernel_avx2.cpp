#include "core/marker/center_kernel.h"

#if defined(__x86_64__)

// All headers that need no AVX2, before those that do.
#include <immintrin.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "core/color/pixel.h"
#include "core/marker/outline_cover.h"
// clang-format off
#include "core/marker/avx2_begin.h"
#include "core/marker/ball_lanes.h"
#include "core/marker/patch_lanes.h"
#include "core/marker/avx2_end.h"
// clang-format on

namespace touchline {

const CenterKernel* avx2_center_kernel() {
  static constexpr CenterKernel kKernel{see_top, see_patch, fit_edge, see_ball, fit_shades, fit_outline};
  return __builtin_cpu_supports("avx2") ? &kKernel : nullptr;
}

}  // namespace touchline

#else

namespace touchline {

const CenterKernel* avx2_center_kernel() { return nullptr; }

}  // namespace touchline

#endif
