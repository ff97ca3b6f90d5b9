#pragma once

#include <array>

#include "core/geometry/camera_model.h"
#include "core/marker/marker_layout.h"
#include "core/subpixel/blurred_outline.h"
#include "core/subpixel/fit_kernel.h"
#include "core/types.h"

namespace touchline {

/// Centers of a recognized robot's patches, each pixel counting by how strongly it belongs to the patch, where the
/// region's centroid (Klancar, section 4.2) counts it wholly or not at all.
///
/// What the camera should show of a robot is known: patches of known outline (w_k, the part of a pixel that patch k
/// covers) on a top of one color T, and beyond the robot's edge (r, the part that the robot covers) whatever is there,
/// O. Light adds up, so that a pixel shows
///   r T + (1 - r) O + sum of w_k (P_k - T).
/// Patch colors P_k are means of the pixels that are wholly covered, T one of the free parts of the top, O what is
/// seen just beyond the robot's edge. A patch's center is where this fits the pixels on its edges best (least squares,
/// Gauss-Newton): a pixel that is half covered says where the edge is, and a neighboring patch does not leak in.
/// Pixels that depend on an O which differs much from T (a line, a wall, another robot's patch) count less.
///
/// A robot keeps the centers it has when the picture does not look like that: no free top, patches of a few pixels,
/// pixels that do not fit. The light map is not needed: light is even over one robot. Work a robot is bounded: of large
/// patches every second, third ... pixel of a row and every such row is looked at.
class PatchCenterFit {
 public:
  /// The layouts of both teams, by Team; a team without one has no patches. They are valid.
  void configure(const std::array<MarkerLayout, 2>& layouts, const CameraModel& camera,
                 KernelChoice kernel = KernelChoice::kFastest);

  /// Moves centers, pose and residual of the robots that have a heading and of which all patches of the layout were
  /// seen. The frame has been accepted by the scan.
  void refine(const Frame& frame, Sightings& sightings);

 private:
  struct Marker {
    MarkerLayout layout;
    FixedVector<BlurredOutline, kMaxPatches> covers;
  };
  class Solver;

  const FitKernel* kernel_ = nullptr;
  std::array<Marker, 2> markers_;
  CameraModel camera_;
  std::array<PatchEdge, kMaxPatches> edges_;  // of the robot that is fitted
};

}  // namespace touchline
