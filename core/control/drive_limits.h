#pragma once

#include "core/control/control_parameters.h"
#include "core/types.h"

namespace touchline {

/// Wheel speeds of a differential drive: v -/+ w b / 2.
WheelSpeeds wheels_of(const Twist& twist, double wheel_base_m);
Twist twist_of(const WheelSpeeds& wheels, double wheel_base_m);

/// Limits `wanted` to the maximum speed, turn rate and wheel speed. Both velocities are scaled by the same factor, so
/// the robot drives the same curve more slowly. A velocity that is not finite gives zero.
Twist within_speed_limits(const Twist& wanted, const DriveParameters& drive);

/// Velocities nearest to `wanted` that the wheels can reach from `last` in dt_s. Each wheel's speed moves towards its
/// new value by at most the same amount. It stays between both values, so no other limit is violated.
Twist within_acceleration_limit(const Twist& wanted, const Twist& last, double dt_s, const DriveParameters& drive);

}  // namespace touchline
