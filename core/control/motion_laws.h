#pragma once

#include "core/control/control_parameters.h"
#include "core/geometry/vector2.h"
#include "core/types.h"

// Control laws: from where a robot is and where it should be to the velocities that take it there. Pure functions; the
// drive's limits are applied afterwards. Robots are as good backwards as forwards.
namespace touchline {

/// With which end forward a robot may arrive.
enum class Facing : std::uint8_t { kExact, kEither };

/// Turns towards the target and drives; the heading at the end is free. `max_speed_mps` is kept up to
/// `arrive` = true: the speed falls with the distance; false: the place is passed at full speed.
Twist go_to_point(const Pose& robot, Vector2 target, bool arrive, double max_speed_mps, const MotionParameters& gains);

/// Closed-loop steering in polar coordinates: Aicardi, Casalino, Bicchi, Balestrino, "Closed loop steering of unicycle
/// like vehicles via Lyapunov techniques", IEEE Robotics & Automation Magazine 2(1), 1995. Its gain gamma may depend on
/// the distance without touching the proof, so the speed is limited inside the law. Drives forward or backward, as is
/// nearer; `twist` (the robot's velocities now) keeps it at what it does when both are about equal.
Twist go_to_pose(const Pose& robot, const Twist& twist, const Pose& target, Facing facing, double max_speed_mps,
                 const MotionParameters& gains);

/// Feed-forward and nonlinear feedback: Samson 1993, in the form of De Luca, Oriolo, Vendittelli, "Control of wheeled
/// mobile robots: an experimental overview", 2001, section 4.3, also in Klancar, Zdesar, Blazic, Skrjanc, "Wheeled
/// Mobile Robotics", 2017, section 3.4. `reference` is where the robot should be now, and its velocities.
Twist track_trajectory(const Pose& robot, const Pose& reference, const Twist& reference_twist,
                       const MotionParameters& gains);

/// Turns in place.
Twist turn_to(const Pose& robot, double heading_rad, Facing facing, const MotionParameters& gains);

/// The same robot looked at from its back: what drives it forward drives the robot backward.
Pose reversed(const Pose& pose);

}  // namespace touchline
