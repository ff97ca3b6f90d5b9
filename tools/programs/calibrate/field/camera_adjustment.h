#pragma once

#include <array>
#include <limits>
#include <optional>
#include <vector>

#include "core/geometry/camera_model.h"
#include "core/marker/matcher.h"
#include "tools/programs/calibrate/field/edge_search.h"
#include "tools/programs/calibrate/field/field_fit.h"

namespace ceres {
class Problem;
}

namespace touchline::calibrate {

/// Indices of the full model's unknowns, which the solver holds in double precision.
enum Intrinsic : std::size_t { kFocal, kAspect, kCenterU, kCenterV, kK1, kK2, kK3, kP1, kP2, kIntrinsics };
struct AdjustedCamera {
  std::array<double, kIntrinsics> intrinsics{};
  std::array<double, 3> rotation{}, position_m{};

  static AdjustedCamera of(const FullModelParameters& full);
  [[nodiscard]] FullModelParameters full() const;
};

/// Standard deviations of the result.
struct CameraUncertainty {
  double height_m = 0, x_m = 0, y_m = 0, tilt_rad = 0;
  double focal_px = 0, center_u_px = 0, center_v_px = 0;
  double floor_center_mm = 0, floor_corner_mm = 0;  // floor position of a pixel, in the center and in the worst corner
  double top_corner_mm = 0;                         // position of a robot's top (kTop_m) in the worst corner
  // Chi-square of the lens parameters under their priors: how unusual the lens is. If the size of the field is wrong,
  // tilt, focal length and distortion compensate with unusual values.
  double lens_chi_square = 0;
};
inline constexpr double kTop_m = 0.075;

/// Evidence about the camera's height from the picture alone. The height follows from the perspective and distortion of
/// the marks, if the lens's center of distortion is near the middle of the picture. It uses neither a given height nor
/// the rules of a league nor the focal lengths of usual lenses.
struct HeightEvidence {
  // sigma_m is infinite if the picture does not show the height. For a camera straight above the field, twice the
  // height with twice the focal length gives nearly the same picture.
  double height_m = 0, sigma_m = std::numeric_limits<double>::infinity();
  double chi_square = 0;  // chi-square of the given height under its standard deviation; 0 if none is given
};

/// Weights of the adjustment: standard deviation of a point, scale of the Cauchy loss beyond which a point has little
/// influence, and the free lens parameters (1: k1; 2: k1, k2 and the principal point; 3: all).
struct AdjustmentWeights {
  double edge_sigma_px = 0.15, loss_px = 1.0;
  int lens = 3;
};

/// Bundle adjustment of one camera: nonlinear least squares on the distances perpendicular to the marks. Unknowns are
/// focal length, principal point, radial (k1 to k3) and tangential distortion, and pose. Priors on the lens and the
/// height hold the parameters that the floor does not determine.
class Adjustment {
 public:
  Adjustment(int width_px, int height_px, const std::optional<HeightPrior>& height, const AdjustedCamera& start);
  /// Returns the same adjustment without the prior of usual focal lengths and with this prior of the height.
  [[nodiscard]] Adjustment of_any_focal_length(const std::optional<HeightPrior>& height) const;

  /// Returns false if the result is not a camera above the floor.
  [[nodiscard]] bool run(const std::vector<MarkPoint>& points, const AdjustmentWeights& weights,
                         AdjustedCamera& camera) const;
  /// Computes standard deviations from the normal equations at the minimum, for the center and corners of `field`. A
  /// standard deviation is infinite if the equations are singular.
  [[nodiscard]] CameraUncertainty uncertainty(const std::vector<MarkPoint>& points, const AdjustmentWeights& weights,
                                              AdjustedCamera camera, const FieldParameters& field) const;
  /// Returns twice the negative log-likelihood of the camera, up to a constant: distances from the marks, and priors.
  [[nodiscard]] double chi_square(const std::vector<MarkPoint>& points, const AdjustmentWeights& weights,
                                  AdjustedCamera camera) const;

 private:
  void build(ceres::Problem& problem, const std::vector<MarkPoint>& points, const AdjustmentWeights& weights,
             AdjustedCamera& camera) const;
  void add_lens_knowledge(ceres::Problem& problem, AdjustedCamera& camera) const;

  int width_px_;
  double center_u_, center_v_, aspect_;
  std::optional<HeightPrior> height_;
  bool usual_focal_length_ = true;
};

}  // namespace touchline::calibrate
