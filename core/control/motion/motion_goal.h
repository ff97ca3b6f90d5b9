#pragma once

#include <optional>

#include "core/control/control_parameters.h"
#include "core/geometry/vector2.h"
#include "core/types.h"

namespace touchline {

/// A robot when the next command begins to act.
struct MotionState {
  Vector2 place;
  double heading_rad = 0.0, v_mps = 0.0, w_radps = 0.0;  // of the body, from the track
  // Velocities of the wheels, from the commands alone. Their difference from the body's velocities is the error of the
  // wheels' gains, or a contact.
  Twist wheels;
};
inline MotionState motion_state(const Pose& pose, const Twist& twist, const Twist& wheels) {
  return {position(pose), heading(pose), static_cast<double>(twist.v_mps), static_cast<double>(twist.w_radps), wheels};
}

/// Returns the command that changes the body's velocities by this much within a period. The change is added to the
/// velocities of the wheels, so the sum of all changes compensates errors of the wheels' gains (a controller in
/// velocity form).
Twist command_to_change(const MotionState& robot, double change_mps, double change_radps, double period_s,
                        const DriveParameters& drive);

/// Where a robot shall drive, and how it arrives.
struct MotionGoal {
  Vector2 place{};
  std::optional<double> direction_rad{};  // of the motion at the place; nullopt: any
  double end_speed_mps = 0.0;             // at the place; 0: the robot stops there
  bool exact_heading = false;             // the heading is direction_rad; otherwise the back may be ahead, too
};

/// Limits for plans, from those of the drive.
struct MotionLimits {
  explicit MotionLimits(const DriveParameters& drive);
  /// Returns the largest speed on a circle: grip, turn rate and the outer wheel limit it.
  [[nodiscard]] double speed_on(double radius_m) const;
  /// Returns the largest turn rate at a speed.
  [[nodiscard]] double turn_at(double speed_mps) const;

  double speed_mps, wheel_mps, turn_radps;
  double half_base_m;
  double wheel_acceleration_mps2;
  double acceleration_mps2, turn_acceleration_radps2;  // of plans that only drive straight, or only turn
  double lateral_mps2;                                 // centripetal acceleration that the tires hold
  double lag_s;
};

}  // namespace touchline
