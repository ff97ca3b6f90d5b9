#include "tests/control/small_world.h"

#include <algorithm>
#include <cmath>

#include "core/geometry/angle.h"

namespace touchline {
namespace {

constexpr double kHalfSide = 0.0375, kBallRadius = 0.02135, kLag = 0.06;
constexpr double kBallDamping = 0.5, kBounce = 0.5, kStep = 0.001;

}  // namespace

void SmallWorld::place_three_robots() {
  for (int i = 0; i < 3; ++i) {
    Robot robot;
    robot.id = static_cast<RobotId>(2 * i + 1);
    robot.position = {-0.9 + 0.4 * i, 0.3 - 0.1 * i};
    robots.push_back(robot);
  }
  ball = {0.3, 0.1};
}

void SmallWorld::obey(const Commands& commands) {
  for (Robot& robot : robots) {
    if (robot.team != Team::kOwn) continue;
    robot.command = {};
    for (const RobotCommand& command : commands.robots) {
      if (command.id == robot.id && !commands.stop) robot.command = command.twist;
    }
  }
}

void SmallWorld::move(Robot& robot, double dt) const {
  robot.v += dt / kLag * (static_cast<double>(robot.command.v_mps) - robot.v);
  robot.w += dt / kLag * (static_cast<double>(robot.command.w_radps) - robot.w);
  if (robot.jammed) return;
  robot.position = robot.position + (dt * robot.v) * unit_vector(robot.heading);
  robot.heading = wrap_angle(robot.heading + dt * robot.w);
  const double x = 0.5 * static_cast<double>(field.length_m) - kHalfSide;
  const double y = 0.5 * static_cast<double>(field.width_m) - kHalfSide;
  robot.position = {std::clamp(robot.position.x, -x, x), std::clamp(robot.position.y, -y, y)};
}

void SmallWorld::separate(double dt) {
  for (std::size_t i = 0; i < robots.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      const Vector2 apart = robots[i].position - robots[k].position;
      const double d = norm(apart), overlap = 2.0 * kHalfSide - d;
      if (overlap <= 0.0 || d < 1e-9) continue;
      const Vector2 shift = (0.5 * overlap / d) * apart;
      if (!robots[i].jammed) robots[i].position = robots[i].position + shift;
      if (!robots[k].jammed) robots[k].position = robots[k].position - shift;
      const bool own = robots[i].team == Team::kOwn && robots[k].team == Team::kOwn;
      if (own) robot_contact_s += dt;
    }
  }
}

void SmallWorld::push_ball(const Robot& robot) {
  // In the robot's frame its body is a box. The ball is moved out of it through the nearest side.
  const Vector2 ahead = unit_vector(robot.heading), left = perpendicular(ahead);
  const Vector2 r = ball - robot.position;
  const Vector2 local{dot(r, ahead), dot(r, left)};
  const Vector2 nearest{std::clamp(local.x, -kHalfSide, kHalfSide), std::clamp(local.y, -kHalfSide, kHalfSide)};
  Vector2 out = local - nearest;
  double depth = kBallRadius - norm(out);
  if (depth <= 0.0) return;
  if (norm(out) > 1e-9) {
    out = (1.0 / norm(out)) * out;
  } else {
    const bool front = std::abs(local.x) > std::abs(local.y);
    out = front ? Vector2{std::copysign(1.0, local.x), 0.0} : Vector2{0.0, std::copysign(1.0, local.y)};
    depth = kBallRadius + kHalfSide - std::abs(front ? local.x : local.y);
  }
  const Vector2 normal = out.x * ahead + out.y * left;
  ball = ball + depth * normal;
  const Vector2 surface = robot.v * ahead + robot.w * perpendicular(r);
  const double closing = dot(surface - ball_velocity, normal);
  if (closing > 0.0) ball_velocity = ball_velocity + 1.2 * closing * normal;
}

void SmallWorld::keep_ball_inside() {
  const double end = 0.5 * static_cast<double>(field.length_m), side = 0.5 * static_cast<double>(field.width_m);
  const bool mouth = std::abs(ball.y) < 0.5 * static_cast<double>(field.goal_width_m) - kBallRadius;
  if (std::abs(ball.x) > end + kBallRadius) {
    (ball.x > 0.0 ? goals : own_goals) += 1;
    ball = ball_velocity = {};
    return;
  }
  if (std::abs(ball.y) > side - kBallRadius) {
    ball.y = std::copysign(side - kBallRadius, ball.y);
    if (ball.y * ball_velocity.y > 0.0) ball_velocity.y *= -kBounce;
  }
  if (!mouth && std::abs(ball.x) > end - kBallRadius) {
    ball.x = std::copysign(end - kBallRadius, ball.x);
    if (ball.x * ball_velocity.x > 0.0) ball_velocity.x *= -kBounce;
  }
}

void SmallWorld::advance(double dt_s) {
  const int steps = static_cast<int>(std::lround(dt_s / kStep));
  for (int i = 0; i < steps; ++i) {
    for (Robot& robot : robots) move(robot, kStep);
    separate(kStep);
    ball_velocity = (1.0 - kStep * kBallDamping) * ball_velocity;
    ball = ball + kStep * ball_velocity;
    for (const Robot& robot : robots) push_ball(robot);
    keep_ball_inside();
    time_s += kStep;
  }
}

Tracks SmallWorld::tracks(std::mt19937* noise, double noise_m) const {
  std::normal_distribution<double> normal;
  const auto scatter = [&](double sigma) { return noise == nullptr ? 0.0 : sigma * normal(*noise); };
  Tracks out;
  out.capture_time = out.action_time = at(time_s);
  for (const Robot& robot : robots) {
    RobotTrack track;
    track.team = robot.team;
    track.id = robot.id;
    track.state = TrackState::kSeen;
    track.last_seen = out.capture_time;
    track.pose = {to_field_point(robot.position + Vector2{scatter(noise_m), scatter(noise_m)}),
                  wrap_to_float(robot.heading + scatter(10.0 * noise_m))};
    track.twist = {static_cast<float>(robot.v), static_cast<float>(robot.w)};
    track.pose_at_action = track.pose;
    track.twist_at_action = track.twist;
    out.robots.push_back(track);
  }
  out.ball.state = TrackState::kSeen;
  out.ball.last_seen = out.capture_time;
  out.ball.position = out.ball.position_at_action = to_field_point(ball + Vector2{scatter(noise_m), scatter(noise_m)});
  out.ball.velocity = out.ball.velocity_at_action = to_field_point(ball_velocity);
  return out;
}

}  // namespace touchline
