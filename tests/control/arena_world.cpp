#include "tests/control/arena_world.h"

#include <cmath>

#include "core/control/control_parameters.h"
#include "core/control/motion/drive_limits.h"
#include "core/geometry/angle.h"
#include "hal/mock/world.h"

namespace touchline {
namespace {

using hal::mock::World;

// An arena whose robots are numbered as those of the test.
hal::mock::ArenaParameters arena_of(const FieldParameters& field, std::size_t robots) {
  hal::mock::ArenaParameters arena;
  arena.physics.wheel_error = arena.physics.wheel_slip = arena.physics.floor_roughness_mps_rts = 0.0;
  arena.field.length_m = static_cast<double>(field.length_m);
  arena.field.width_m = static_cast<double>(field.width_m);
  arena.field.goal_width_m = static_cast<double>(field.goal_width_m);
  arena.field.goal_depth_m = static_cast<double>(field.goal_depth_m);
  arena.robot.clear();
  for (std::size_t i = 0; i < robots; ++i) {
    arena.robot.push_back({.id = static_cast<int>(i), .colors = {"red"}});
  }
  return arena;
}

void put(World& world, std::size_t index, const ArenaWorld::Robot& robot) {
  world.place(index, {robot.position.x, robot.position.y, robot.heading}, robot.velocity, robot.w);
}

}  // namespace

void ArenaWorld::place_three_robots() {
  for (int i = 0; i < 3; ++i) {
    Robot robot;
    robot.id = static_cast<RobotId>(2 * i + 1);
    robot.position = {-0.9 + 0.4 * i, 0.3 - 0.1 * i};
    robots.push_back(robot);
  }
  ball = {0.3, 0.1};
}

void ArenaWorld::obey(const Commands& commands) {
  for (Robot& robot : robots) {
    if (robot.team != Team::kOwn) continue;
    robot.command = {};
    for (const RobotCommand& command : commands.robots) {
      if (command.id == robot.id && !commands.stop) robot.command = command.twist;
    }
  }
}

void ArenaWorld::watch_goals() {
  constexpr double kBallRadius = 0.02135;
  if (std::abs(ball.x) <= 0.5 * static_cast<double>(field.length_m) + kBallRadius) return;
  (ball.x > 0.0 ? goals : own_goals) += 1;
  ball = ball_velocity = {};
}

void ArenaWorld::advance(double dt_s) {
  World world(arena_of(field, robots.size()), 1);
  for (std::size_t i = 0; i < robots.size(); ++i) {
    put(world, i, robots[i]);
    const WheelSpeeds wheels = wheels_of(robots[i].command, DriveParameters{}.wheel_base_m);
    world.drive(static_cast<int>(i), static_cast<double>(wheels.left_mps), static_cast<double>(wheels.right_mps));
  }
  world.place_ball({ball.x, ball.y, 0.0}, ball_velocity);
  const int steps = static_cast<int>(std::lround(dt_s / World::kStepS));
  for (int step = 0; step < steps; ++step) {
    const hal::mock::Snapshot before = world.snapshot();
    world.step();
    const hal::mock::Snapshot after = world.snapshot();
    for (std::size_t i = 0; i < robots.size(); ++i) {
      Robot& robot = robots[i];
      if (robot.jammed) {
        robot.velocity = {};
        robot.w = 0.0;
        put(world, i, robot);
        continue;
      }
      const hal::mock::Placement& from = before.robots[i];
      const hal::mock::Placement& to = after.robots[i];
      robot.position = {to.x_m, to.y_m};
      robot.heading = to.theta_rad;
      robot.velocity = (1.0 / World::kStepS) * Vector2{to.x_m - from.x_m, to.y_m - from.y_m};
      robot.w = wrap_angle(to.theta_rad - from.theta_rad) / World::kStepS;
      for (std::size_t k = 0; k < i; ++k) {
        const bool own = robot.team == Team::kOwn && robots[k].team == Team::kOwn;
        if (own && (world.touching(i) >> k & 1U) != 0) robot_contact_s += World::kStepS;
      }
    }
    ball = world.ball();
    ball_velocity = world.ball_velocity();
    const int counted = goals + own_goals;
    watch_goals();
    if (goals + own_goals != counted) world.place_ball({ball.x, ball.y, 0.0});
    time_s += World::kStepS;
  }
}

Tracks ArenaWorld::tracks(std::mt19937* noise, double noise_m) const {
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
    track.twist = {static_cast<float>(dot(robot.velocity, unit_vector(robot.heading))), static_cast<float>(robot.w)};
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
