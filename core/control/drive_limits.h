#pragma once

#include "core/control/control_parameters.h"
#include "core/types.h"

namespace touchline {

/// Rim speeds of a differential drive: v -/+ w b / 2.
WheelSpeeds wheels_of(const Twist& twist, double wheel_base_m);
Twist twist_of(const WheelSpeeds& wheels, double wheel_base_m);

/// `wanted` within the limits of speed, turn rate and wheel speed. Both velocities are scaled by one factor: the robot
/// goes the same curve, only slower. What is no number becomes zero.
Twist within_speed_limits(const Twist& wanted, const DriveParameters& drive);

/// The nearest to `wanted` that the wheels can reach from `last` in dt_s. Both wheels change at the same rate at most,
/// so that each velocity lies between its two values and no other limit is broken on the way.
Twist within_acceleration_limit(const Twist& wanted, const Twist& last, double dt_s, const DriveParameters& drive);

}  // namespace touchline
