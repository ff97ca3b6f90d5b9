#pragma once

#include <array>

#include "hal/mock/arena_parameters.h"

namespace touchline::hal::mock {

using Vec3 = std::array<double, 3>;

/// The arena's camera: a fisheye lens whose radius grows with the angle to the axis, r = f (a + cubic a^3) (Kannala and
/// Brandt, "A Generic Camera Model and Calibration Method", 2006), looking from a place at a point of the floor. On
/// purpose neither of the models that the pipeline inverts with. A negative factor lets the radius grow up to some
/// angle only; directions and pixels beyond are taken as that angle's.
class Lens {
 public:
  explicit Lens(const LensParameters& parameters);

  /// u, v in pixels of a point of the field frame.
  [[nodiscard]] std::array<double, 2> project(Vec3 point_m) const;
  /// Unit vector of the line of sight, field frame.
  [[nodiscard]] Vec3 direction(double u_px, double v_px) const;
  [[nodiscard]] Vec3 position_m() const { return position_; }

 private:
  double focal_, cubic_, widest_rad_;
  std::array<double, 2> center_{};
  Vec3 position_{};
  std::array<Vec3, 3> rotation_{};  // rows: the camera's right, down and forward in the field frame
};

}  // namespace touchline::hal::mock
