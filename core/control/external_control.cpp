#include "core/control/external_control.h"

#include <algorithm>

#include "core/control/drive_limits.h"
#include "core/control/motion_laws.h"
#include "core/control/obstacle_avoidance.h"

namespace touchline {
namespace {

Twist drive_to(const ExternalCommand& command, const Player& robot, const Tracks& tracks,
               const ControlParameters& parameters, const FieldParameters& field) {
  const Vector2 here = position(robot.pose), target = position(command.target);
  const double speed = parameters.drive.max_speed_mps;
  Obstacles obstacles;
  obstacles_for(robot.id, tracks, obstacles);
  const Vector2 next = detour(here, target, obstacles, parameters.play.clearance_m, field);
  if (distance(next, target) > 1e-9) return go_to_point(robot.pose, next, false, speed, parameters.motion);
  if (!command.has_heading) return go_to_point(robot.pose, target, true, speed, parameters.motion);
  return go_to_pose(robot.pose, robot.twist, command.target, Facing::kExact, speed, parameters.motion);
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

Twist twist_of(const ExternalCommand& command, const Player& robot, const Tracks& tracks,
               const ControlParameters& parameters, const FieldParameters& field) {
  switch (command.kind) {
    case ExternalCommand::Kind::kRelease:
      break;
    case ExternalCommand::Kind::kTwist:
      return command.twist;
    case ExternalCommand::Kind::kWheels:
      return twist_of(command.wheels, parameters.drive.wheel_base_m);
    case ExternalCommand::Kind::kPose:
      return drive_to(command, robot, tracks, parameters, field);
  }
  return {};
}

}  // namespace touchline
