#pragma once

#include "core/control/control_parameters.h"
#include "core/types.h"

namespace touchline {

/// Returns the wheel speeds of a differential drive: v -/+ w b / 2.
WheelSpeeds wheels_of(const Twist& twist, double wheel_base_m);
Twist twist_of(const WheelSpeeds& wheels, double wheel_base_m);

/// Limits `wanted` to the maximum speed, turn rate and wheel speed. Both velocities are scaled by the same factor, so
/// the robot drives the same curve more slowly. A velocity that is not finite gives zero.
Twist within_speed_limits(const Twist& wanted, const DriveParameters& drive);

/// Returns the velocities nearest to `wanted` that the wheels can reach from `last` in dt_s. Both wheels change their
/// speed towards the new value by at most the same amount. Each speed stays between its old and its new value, so no
/// other limit is violated.
Twist within_acceleration_limit(const Twist& wanted, const Twist& last, double dt_s, const DriveParameters& drive);

}  // namespace touchline
