#include "core/control/motion/drive_limits.h"

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

double wheel_response(double period_s, const DriveParameters& drive) {
  return drive.wheel_lag_s > 0.0 ? -std::expm1(-std::max(0.0, period_s) / drive.wheel_lag_s) : 1.0;
}

Twist wheels_after(const Twist& wheels, const Twist& command, double period_s, const DriveParameters& drive) {
  const auto share = static_cast<float>(wheel_response(period_s, drive));
  return {wheels.v_mps + share * (command.v_mps - wheels.v_mps),
          wheels.w_radps + share * (command.w_radps - wheels.w_radps)};
}

Twist command_for(const Twist& wanted, const Twist& wheels, double period_s, const DriveParameters& drive) {
  const double share = wheel_response(period_s, drive);
  if (!(share > 0.0)) return wheels;
  const auto gain = static_cast<float>(1.0 / share);
  return {wheels.v_mps + gain * (wanted.v_mps - wheels.v_mps),
          wheels.w_radps + gain * (wanted.w_radps - wheels.w_radps)};
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

Twist within_acceleration_limit(const Twist& wanted, const Twist& wheels, double period_s,
                                const DriveParameters& drive) {
  const double share = wheel_response(period_s, drive);
  const double change_mps = drive.max_wheel_acceleration_mps2 * std::max(0.0, period_s);
  const auto step = share > 0.0 ? static_cast<float>(change_mps / share) : 0.0f;
  const WheelSpeeds to = wheels_of(wanted, drive.wheel_base_m), from = wheels_of(wheels, drive.wheel_base_m);
  return twist_of({std::clamp(to.left_mps, from.left_mps - step, from.left_mps + step),
                   std::clamp(to.right_mps, from.right_mps - step, from.right_mps + step)},
                  drive.wheel_base_m);
}

}  // namespace touchline
