#pragma once

#include <array>

#include "hal/mock/arena_parameters.h"

namespace touchline::hal::mock {

using Vec3 = std::array<double, 3>;

/// Models the arena's camera as a fisheye lens with the image radius r = f (a + cubic a^3), where a is the angle to the
/// optical axis (Kannala and Brandt, "A Generic Camera Model and Calibration Method", 2006). The camera hangs at
/// `position_m` and points at `aim_m` on the floor. The model differs on purpose from the two camera models that the
/// pipeline uses. With a negative `cubic` the radius has a maximum; directions and pixels beyond it are clamped to it.
class Lens {
 public:
  explicit Lens(const LensParameters& parameters);

  /// Projects a point of the field frame to u, v in pixels.
  [[nodiscard]] std::array<double, 2> project(Vec3 point_m) const;
  /// Returns the unit vector of the pixel's viewing ray in the field frame.
  [[nodiscard]] Vec3 unproject(double u_px, double v_px) const;
  [[nodiscard]] Vec3 position_m() const { return position_; }

 private:
  double focal_, cubic_, max_angle_rad_;
  std::array<double, 2> center_{};
  Vec3 position_{};
  std::array<Vec3, 3> rotation_{};  // rows: the camera's right, down and forward axes in the field frame
};

}  // namespace touchline::hal::mock
