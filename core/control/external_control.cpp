#include "core/control/external_control.h"

#include <algorithm>

#include "core/control/motion/drive_limits.h"

namespace touchline {
namespace {

MotionGoal goal_of(const ExternalCommand& command) {
  MotionGoal goal;
  goal.place = position(command.target);
  if (command.has_heading) goal.direction_rad = heading(command.target);
  goal.exact_heading = true;
  return goal;
}

}  // namespace

const ExternalCommand* ExternalControl::command_of(RobotId id) const {
  const auto* const found = std::find_if(commands_.begin(), commands_.end(),
                                         [id](const ExternalCommand& command) { return command.id == id; });
  return found == commands_.end() || found->kind == ExternalCommand::Kind::kRelease ? nullptr : found;
}

bool ExternalControl::is_expired(const ExternalCommand& command, const ExternalParameters& parameters) const {
  return now_ - command.received > from_seconds(parameters.max_age_s);
}

Twist twist_of(const ExternalCommand& command, const Player& robot, MotionPlanner& motion,
               const DriveParameters& drive) {
  switch (command.kind) {
    case ExternalCommand::Kind::kRelease:
      break;
    case ExternalCommand::Kind::kTwist:
      return command.twist;
    case ExternalCommand::Kind::kWheels:
      return twist_of(command.wheels, drive.wheel_base_m);
    case ExternalCommand::Kind::kPose:
      return motion.drive(robot.id, motion_state(robot.pose, robot.twist, robot.wheels), goal_of(command));
  }
  return {};
}

}  // namespace touchline
