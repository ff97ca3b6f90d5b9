#pragma once

#include "core/geometry/vector2.h"
#include "core/types.h"
#include "tools/programs/simulate/release_0_1/parameters.h"

// Control laws: they compute a robot's velocities from its pose and its target. They are pure functions; the limits of
// the drive are applied afterwards. Robots drive backward as well as forward.
namespace touchline::release_0_1 {

/// Whether a robot must arrive with its front ahead, or may also arrive rotated by 180 degrees.
enum class Facing : std::uint8_t { kExact, kEither };

/// Turns towards the target and drives to it; the final heading is free. If `arrive` is true, the speed decreases with
/// the distance; otherwise the robot passes the target at `max_speed_mps`.
Twist go_to_point(const Pose& robot, Vector2 target, bool arrive, double max_speed_mps, const MotionParameters& gains);

/// Drives to a pose by closed-loop steering in polar coordinates: Aicardi, Casalino, Bicchi, Balestrino, "Closed loop
/// steering of unicycle like vehicles via Lyapunov techniques", IEEE Robotics & Automation Magazine 2(1), 1995. Its
/// gain gamma may depend on the distance without invalidating the proof, so the speed is limited inside the law. Drives
/// forward or backward, whichever is shorter. `twist` is the robot's current velocity; the robot keeps its driving
/// direction if both are about equally good.
Twist go_to_pose(const Pose& robot, const Twist& twist, const Pose& target, Facing facing, double max_speed_mps,
                 const MotionParameters& gains);

/// Tracks a trajectory with feed-forward and nonlinear feedback: Samson 1993, in the form of De Luca, Oriolo,
/// Vendittelli, "Control of wheeled mobile robots: an experimental overview", 2001, section 4.3, also in Klancar,
/// Zdesar, Blazic, Skrjanc, "Wheeled Mobile Robotics", 2017, section 3.4. `reference` is the desired pose at this time,
/// `reference_twist` its velocities.
Twist track_trajectory(const Pose& robot, const Pose& reference, const Twist& reference_twist,
                       const MotionParameters& gains);

/// Turns in place.
Twist turn_to(const Pose& robot, double heading_rad, Facing facing, const MotionParameters& gains);

/// Returns the pose rotated by 180 degrees: driving forward from it is driving backward from `pose`.
Pose reversed(const Pose& pose);

}  // namespace touchline::release_0_1
