#pragma once

// Trapezoidal profiles along a way or an angle. Units: m, m/s, m/s^2, or rad, rad/s, rad/s^2.
namespace touchline {

struct ProfileLimits {
  double speed = 0.0, acceleration = 0.0;
  // Periods in which the last part of a way is closed. One would be dead beat and multiply the noise of the track by
  // the frame rate.
  double periods_to_close = 2.0;
};

/// Returns the time over a way >= 0 that begins with `begin` (negative: away from the goal) and ends with `end` >= 0. A
/// robot that cannot brake in time passes its goal and returns; one that cannot reach `end` in time arrives more
/// slowly.
double profile_time(double way, double begin, double end, const ProfileLimits& limits);

/// Returns the speed at the end of a period for the time-optimal profile. The way may be negative: behind the robot.
/// Near the goal, the speed is proportional to the way left.
double next_speed(double way, double now, double end, double period_s, const ProfileLimits& limits);

}  // namespace touchline
