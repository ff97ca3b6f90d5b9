#pragma once

#include <cmath>
#include <concepts>
#include <numbers>

namespace touchline {

/// Wraps an angle to (-pi, pi], pi as rounded to the type.
template <std::floating_point Float>
Float wrap_angle(Float angle_rad) {
  constexpr Float kPi = std::numbers::pi_v<Float>;
  if (angle_rad > -kPi && angle_rad <= kPi) return angle_rad;
  const Float wrapped = std::remainder(angle_rad, Float{2} * kPi);
  return wrapped > -kPi ? wrapped : kPi;
}

/// Wraps an angle to (-pi, pi] and rounds it to float. The result stays in this interval, although pi rounded to float
/// exceeds pi.
inline float wrap_to_float(double angle_rad) {
  constexpr float kPi = std::numbers::pi_v<float>;
  const auto wrapped = static_cast<float>(wrap_angle(angle_rad));
  return wrapped >= kPi || wrapped <= -kPi ? std::nextafter(kPi, 0.0f) : wrapped;
}

}  // namespace touchline
