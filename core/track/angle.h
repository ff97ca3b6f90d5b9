#pragma once

#include <cmath>
#include <numbers>

namespace touchline {

/// The same angle in (-pi, pi].
inline double wrap_angle(double angle_rad) {
  if (angle_rad > -std::numbers::pi && angle_rad <= std::numbers::pi) return angle_rad;
  const double wrapped = std::remainder(angle_rad, 2.0 * std::numbers::pi);
  return wrapped > -std::numbers::pi ? wrapped : std::numbers::pi;
}

/// For angles that leave the stage as float: rounding must not carry them out of (-pi, pi].
inline float wrap_to_float(double angle_rad) {
  constexpr float kPi = std::numbers::pi_v<float>;  // a little above pi
  const auto wrapped = static_cast<float>(wrap_angle(angle_rad));
  return wrapped >= kPi || wrapped <= -kPi ? std::nextafter(kPi, 0.0f) : wrapped;
}

}  // namespace touchline
