#include "core/control/drive_limits.h"

#include <algorithm>
#include <cmath>

namespace touchline {

WheelSpeeds wheels_of(const Twist& twist, double wheel_base_m) {
  const float half = 0.5f * static_cast<float>(wheel_base_m) * twist.w_radps;
  return {twist.v_mps - half, twist.v_mps + half};
}

Twist twist_of(const WheelSpeeds& wheels, double wheel_base_m) {
  return {0.5f * (wheels.left_mps + wheels.right_mps),
          (wheels.right_mps - wheels.left_mps) / static_cast<float>(wheel_base_m)};
}

Twist within_speed_limits(const Twist& wanted, const DriveParameters& drive) {
  if (!std::isfinite(wanted.v_mps) || !std::isfinite(wanted.w_radps)) return {};
  const auto share = [](double value, double limit) { return std::abs(value) > limit ? limit / std::abs(value) : 1.0; };
  const WheelSpeeds wheels = wheels_of(wanted, drive.wheel_base_m);
  const double scale = std::min({share(static_cast<double>(wanted.v_mps), drive.max_speed_mps),
                                 share(static_cast<double>(wanted.w_radps), drive.max_turn_radps),
                                 share(static_cast<double>(wheels.left_mps), drive.max_wheel_speed_mps),
                                 share(static_cast<double>(wheels.right_mps), drive.max_wheel_speed_mps)});
  return {static_cast<float>(scale * static_cast<double>(wanted.v_mps)),
          static_cast<float>(scale * static_cast<double>(wanted.w_radps))};
}

Twist within_acceleration_limit(const Twist& wanted, const Twist& last, double dt_s, const DriveParameters& drive) {
  const auto change = static_cast<float>(drive.max_wheel_acceleration_mps2 * std::max(0.0, dt_s));
  const WheelSpeeds to = wheels_of(wanted, drive.wheel_base_m), from = wheels_of(last, drive.wheel_base_m);
  return twist_of({std::clamp(to.left_mps, from.left_mps - change, from.left_mps + change),
                   std::clamp(to.right_mps, from.right_mps - change, from.right_mps + change)},
                  drive.wheel_base_m);
}

}  // namespace touchline
