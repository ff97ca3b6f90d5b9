#pragma once

#include <array>
#include <optional>
#include <vector>

#include "core/geometry/camera_model.h"
#include "core/marker/matcher.h"
#include "tools/programs/calibrate/edge_search.h"
#include "tools/programs/calibrate/field_fit.h"

namespace touchline::calibrate {

/// The full model's unknowns in double precision, as the solver holds them.
enum Intrinsic : std::size_t { kFocal, kAspect, kCenterU, kCenterV, kK1, kK2, kK3, kP1, kP2, kIntrinsics };
struct AdjustedCamera {
  std::array<double, kIntrinsics> intrinsics{};
  std::array<double, 3> rotation{}, position_m{};

  static AdjustedCamera of(const FullModelParameters& full);
  [[nodiscard]] FullModelParameters full() const;
};

/// Standard deviations of what was found.
struct CameraUncertainty {
  double height_m = 0, x_m = 0, y_m = 0, tilt_rad = 0;
  double focal_px = 0, center_u_px = 0, center_v_px = 0;
  double floor_center_mm = 0, floor_corner_mm = 0;  // of a place of the floor seen at a pixel; the worst corner's
  double top_corner_mm = 0;                         // of a robot's top there, kTop_m above
  // How unusual the lens is: squares of what its terms are beside what is known of lenses, over their deviations. A
  // wrong size of the field is made up for by tilt, focal length and such terms.
  double strain = 0;
};
inline constexpr double kTop_m = 0.075;

/// How an adjustment weighs points: how well a point's place is known, the scale of the loss (Cauchy) beyond which it
/// hardly counts, and how much of the lens is free (1: k1; 2: k1, k2 and the principal point; 3: all).
struct AdjustmentWeights {
  double edge_sigma_px = 0.15, loss_px = 1.0;
  int lens = 3;
};

/// Nonlinear least squares on the distances across the marks over focal length, principal point, radial (k1 to k3) and
/// tangential distortion and pose. What the floor cannot tell is held by what is known of lenses and of the height.
class Adjustment {
 public:
  Adjustment(int width_px, int height_px, const std::optional<HeightPrior>& height, const AdjustedCamera& start);

  /// False: no camera above the floor.
  [[nodiscard]] bool run(const std::vector<MarkPoint>& points, const AdjustmentWeights& weights,
                         AdjustedCamera& camera) const;
  /// From the normal equations at the minimum. `field`: whose center and corners are meant. Infinite where they are
  /// singular.
  [[nodiscard]] CameraUncertainty uncertainty(const std::vector<MarkPoint>& points, const AdjustmentWeights& weights,
                                              AdjustedCamera camera, const FieldParameters& field) const;

 private:
  int width_px_;
  double center_u_, center_v_, aspect_;
  std::optional<HeightPrior> height_;
};

}  // namespace touchline::calibrate
