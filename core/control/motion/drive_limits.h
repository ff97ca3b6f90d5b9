#pragma once

#include "core/control/control_parameters.h"
#include "core/types.h"

namespace touchline {

/// Returns the wheel speeds of a differential drive: v -/+ w b / 2.
WheelSpeeds wheels_of(const Twist& twist, double wheel_base_m);
Twist twist_of(const WheelSpeeds& wheels, double wheel_base_m);

/// Returns the share of the difference between command and wheel speed that is gone after a period of one command:
/// 1 - exp(-T / lag), the exact response of a first-order lag to a constant command.
double wheel_response(double period_s, const DriveParameters& drive);

/// Returns the velocities of the wheels after a period in which `command` acts.
Twist wheels_after(const Twist& wheels, const Twist& command, double period_s, const DriveParameters& drive);

/// Inverts the lag: the command with which the wheels change from `wheels` to `wanted` in one period.
Twist command_for(const Twist& wanted, const Twist& wheels, double period_s, const DriveParameters& drive);

/// Limits a command to the maximum speed, turn rate and wheel speed. Both velocities are scaled by the same factor, so
/// the robot drives the same curve more slowly. A velocity that is not finite gives zero.
Twist within_speed_limits(const Twist& wanted, const DriveParameters& drive);

/// Returns the command nearest to `wanted` with which no wheel accelerates, in the mean of the period, by more than the
/// limit: |command - wheel| <= a T / (1 - exp(-T / lag)). `wheels`: predicted velocities of the wheels when the command
/// begins to act. Each speed stays between its predicted and its wanted value, so no other limit is violated.
Twist within_acceleration_limit(const Twist& wanted, const Twist& wheels, double period_s,
                                const DriveParameters& drive);

}  // namespace touchline
