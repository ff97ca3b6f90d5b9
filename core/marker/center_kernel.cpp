#include "core/marker/center_kernel.h"

#include <algorithm>

#include "core/marker/ball_lanes.h"
#include "core/marker/patch_lanes.h"

namespace touchline {

const CenterKernel& portable_center_kernel() {
  static constexpr CenterKernel kKernel{see_top, see_patch, fit_edge, see_ball, fit_shades, fit_outline};
  return kKernel;
}

const CenterKernel& center_kernel(KernelChoice choice) {
  const CenterKernel* avx2 = choice == KernelChoice::kPortable ? nullptr : avx2_center_kernel();
  return avx2 != nullptr ? *avx2 : portable_center_kernel();
}

int stride_of(float reach_px, float all_px) { return 1 + static_cast<int>(std::min(reach_px, 4000.0f) / all_px); }

}  // namespace touchline
