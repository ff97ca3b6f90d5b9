#include "tools/programs/simulate/release_0_1/ball_approach.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/geometry/angle.h"
#include "tools/programs/simulate/release_0_1/motion_laws.h"

namespace touchline::release_0_1 {
namespace {

// Drives along the line through the ball, with the front or the back ahead, whichever points more along the line.
Twist follow_line(const Pose& robot, const PushPlan& plan, double speed, const MotionParameters& gains) {
  const double line = bearing(plan.direction);
  const bool backward = std::abs(wrap_angle(line - heading(robot))) > 0.5 * std::numbers::pi;
  const Pose front = backward ? release_0_1::reversed(robot) : robot;
  // The reference is the robot's projection on the line. The distance to the line is limited, because the law is
  // proportional and would turn a distant robot by more than 90 degrees.
  constexpr double kMaxOffset = 0.15;
  const Vector2 from_ball = position(robot) - plan.ball;
  const double beside = cross(plan.direction, from_ball);
  const Vector2 on_line = position(robot) - std::clamp(beside, -kMaxOffset, kMaxOffset) * perpendicular(plan.direction);
  const Pose reference{to_field_point(on_line), wrap_to_float(line)};
  Twist twist = track_trajectory(front, reference, {static_cast<float>(speed), 0.0f}, gains);
  if (backward) twist.v_mps = -twist.v_mps;
  return twist;
}

}  // namespace

PushPlan plan_push(Vector2 ball, const FieldParameters& field, const PlayParameters& play) {
  const double end = 0.5 * static_cast<double>(field.length_m), side = 0.5 * static_cast<double>(field.width_m);
  const double mouth = 0.5 * static_cast<double>(field.goal_width_m);
  const Vector2 goal{end + 0.5 * static_cast<double>(field.goal_depth_m),
                     std::clamp(ball.y, -0.5 * mouth, 0.5 * mouth)};
  PushPlan plan;
  plan.ball = ball;
  Vector2 d = goal - ball;
  const bool at_side = std::abs(ball.y) > side - play.wall_m;
  const bool at_own_end = ball.x < -end + play.wall_m && std::abs(ball.y) > mouth;
  const bool at_far_end = ball.x > end - play.wall_m && std::abs(ball.y) > mouth;
  plan.in_corner = at_side && (at_own_end || at_far_end);
  if (at_side) d = {1.0, 0.0};                            // along the side wall
  if (at_own_end) d = {0.0, std::copysign(1.0, ball.y)};  // along the end wall, away from the own goal
  // Along the end wall into the goal, with some pressure against the wall, so the ball does not roll past the goal.
  if (at_far_end && !at_side) d = {0.3, -std::copysign(1.0, ball.y)};
  const double length = norm(d);
  plan.direction = length > 1e-6 ? (1.0 / length) * d : Vector2{1.0, 0.0};
  plan.behind = ball - play.behind_ball_m * plan.direction;
  // Keep a distance to the walls, so the attacker does not touch them.
  const double margin = play.robot_radius_m + 0.005;
  plan.behind = {std::clamp(plan.behind.x, -end + margin, end - margin),
                 std::clamp(plan.behind.y, -side + margin, side - margin)};
  return plan;
}

Approach go_to_ball(const Pose& robot, const Twist& twist, const PushPlan& plan, const PlayParameters& play,
                    const DriveParameters& drive, const MotionParameters& gains) {
  const Vector2 from_ball = position(robot) - plan.ball;
  const double rho = norm(from_ball);
  Approach approach;
  if (plan.in_corner) {
    // The spinning robot moves the ball along the wall: along the side wall from an own corner, along the end wall to
    // the goal from a far corner.
    const double touching = 2.0 * play.robot_radius_m + 0.01;
    if (rho < touching) {
      approach.phase = ApproachPhase::kSpin;
      approach.target = position(robot);
      approach.twist = {0.0f, static_cast<float>(std::copysign(drive.max_turn_radps, -plan.ball.y))};
    } else {
      approach.phase = ApproachPhase::kBehind;
      approach.target = plan.ball;
      approach.twist = go_to_point(robot, plan.ball, true, play.push_speed_mps, gains);
    }
    return approach;
  }

  const double behind = -dot(from_ball, plan.direction);
  const double beside = cross(plan.direction, from_ball);
  if (behind > 0.0 &&
      std::abs(beside) < play.corridor_m + play.corridor_slope * std::max(0.0, behind - play.behind_ball_m)) {
    approach.phase = ApproachPhase::kPush;
    approach.target = plan.ball;
    approach.twist = follow_line(robot, plan, play.push_speed_mps, gains);
    return approach;
  }

  // Bearing of the robot as seen from the ball, and the angle from this bearing to the place behind the ball.
  const double now = bearing(from_ball);
  const double around = wrap_angle(bearing(plan.behind - plan.ball) - now);
  // Angle at which a straight line from the robot touches the circle around the ball, plus a margin so that the robot
  // keeps turning.
  const double radius = play.behind_ball_m;
  const double tangent = (rho > radius ? std::acos(radius / rho) : 0.0) + 0.35;
  if (std::abs(around) <= tangent) {
    approach.phase = ApproachPhase::kBehind;
    approach.target = plan.behind;
    const Pose target{to_field_point(plan.behind), wrap_to_float(bearing(plan.direction))};
    approach.twist = go_to_pose(robot, twist, target, Facing::kEither, drive.max_speed_mps, gains);
  } else {
    approach.phase = ApproachPhase::kAround;
    approach.target = plan.ball + radius * unit_vector(now + std::copysign(tangent, around));
    approach.twist = go_to_point(robot, approach.target, false, drive.max_speed_mps, gains);
  }
  return approach;
}

}  // namespace touchline::release_0_1
