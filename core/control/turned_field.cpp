#include "core/control/turned_field.h"

#include <numbers>

#include "core/geometry/angle.h"

namespace touchline {
namespace {

FieldPoint turned(const FieldPoint& point) { return {-point.x_m, -point.y_m}; }

}  // namespace

Pose turned(const Pose& pose) {
  return {turned(pose.position), wrap_to_float(static_cast<double>(pose.theta_rad) + std::numbers::pi)};
}

void turn(const Tracks& tracks, Tracks& out) {
  out = tracks;
  BallTrack& ball = out.ball;
  for (FieldPoint* const value : {&ball.position, &ball.velocity, &ball.position_at_action, &ball.velocity_at_action}) {
    *value = turned(*value);
  }
  // Velocities are relative to the robot's heading, so they do not change.
  for (RobotTrack& robot : out.robots) {
    robot.pose = turned(robot.pose);
    robot.pose_at_action = turned(robot.pose_at_action);
  }
}

}  // namespace touchline
