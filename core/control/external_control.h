#pragma once

#include "core/control/control_parameters.h"
#include "core/control/external_command.h"
#include "core/control/motion/motion_planner.h"
#include "core/control/player.h"
#include "core/types.h"

namespace touchline {

/// Holds the commands of other programs and decides whether they are recent enough.
class ExternalControl {
 public:
  /// `now`: the time of the next decision, on the clock of ExternalCommand::received.
  void set(const ExternalCommands& commands, Instant now) {
    commands_ = commands;
    now_ = now;
  }
  /// Returns the robot's command, or null if the built-in play drives the robot.
  [[nodiscard]] const ExternalCommand* command_of(RobotId id) const;
  [[nodiscard]] bool is_expired(const ExternalCommand& command, const ExternalParameters& parameters) const;

 private:
  ExternalCommands commands_;
  Instant now_{};
};

/// Returns the velocities that the command asks for, without limits. To a pose, the robot drives around the other
/// robots of `motion`, but not around the ball. The command, the robot and `motion` have the same coordinates.
Twist twist_of(const ExternalCommand& command, const Player& robot, MotionPlanner& motion,
               const DriveParameters& drive);

}  // namespace touchline
