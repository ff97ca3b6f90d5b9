#include "tests/strategies/strategy_game.h"

#include <gtest/gtest.h>

#include "core/geometry/angle.h"

namespace touchline::hal::mock {
namespace {

constexpr double kFrameS = StrategyGame::kStepsPerFrame * World::kStepS;

StrategyPointer configured(std::string_view name, std::uint64_t seed, const ArenaField& field, Controller& controller) {
  const StrategyCatalog catalog;
  auto strategy = catalog.create(name, seed);
  EXPECT_TRUE(strategy.ok()) << strategy.text();
  FieldParameters size;
  size.length_m = static_cast<float>(field.length_m);
  size.width_m = static_cast<float>(field.width_m);
  size.goal_width_m = static_cast<float>(field.goal_width_m);
  controller.set_strategy(strategy.value().get());
  EXPECT_TRUE(controller.configure(parameters_for(*catalog.find(name), {}), size).ok());
  return std::move(strategy).value();
}

}  // namespace

ArenaParameters arena_of(const std::vector<Placement>& robots) {
  ArenaParameters arena;
  arena.robot.clear();
  for (const Placement& place : robots) {
    arena.robot.push_back(
        {Side::kOwn, static_cast<int>(arena.robot.size()), place.x_m, place.y_m, place.theta_rad, {}});
  }
  return arena;
}

StrategyGame::StrategyGame(const ArenaParameters& arena, std::string_view strategy, std::uint64_t seed)
    : arena_(arena),
      world_(std::make_unique<World>(arena, 1)),
      rules_(std::make_unique<GameRules>(arena, *world_, 1)),
      strategy_(configured(strategy, seed, arena.field, controller_)),
      before_(world_->snapshot()),
      snapshot_(before_) {}

void StrategyGame::play_frame() {
  controller_.decide(tracks(), false, commands_);
  for (const RobotCommand& robot : commands_.robots) {
    world_->drive(robot.id, static_cast<double>(robot.wheels.left_mps), static_cast<double>(robot.wheels.right_mps));
  }
  for (int step = 0; step < kStepsPerFrame; ++step) {
    world_->step();
    rules_->update();
  }
  before_ = snapshot_;
  snapshot_ = world_->snapshot();
  time_s_ += kFrameS;
}

Tracks StrategyGame::tracks() const {
  Tracks tracks;
  tracks.capture_time = tracks.action_time = Instant{} + from_seconds(time_s_);
  const auto velocity = [](const Placement& now, const Placement& then) {
    const Vector2 way = at(now) - at(then);
    // A ball that was placed does not fly there.
    return norm(way) < 0.1 ? (1.0 / kFrameS) * way : Vector2{};
  };
  tracks.ball.state = TrackState::kSeen;
  tracks.ball.position = tracks.ball.position_at_action = to_field_point(ball());
  tracks.ball.velocity = tracks.ball.velocity_at_action = to_field_point(velocity(snapshot_.ball, before_.ball));
  for (std::size_t i = 0; i < snapshot_.robots.size(); ++i) {
    const Placement &now = snapshot_.robots[i], &then = before_.robots[i];
    RobotTrack robot;
    robot.team = arena_.robot[i].team == Side::kOwn ? Team::kOwn : Team::kOpponent;
    robot.id = static_cast<RobotId>(arena_.robot[i].id);
    robot.state = TrackState::kSeen;
    robot.pose = robot.pose_at_action = {to_field_point(at(now)), wrap_to_float(now.theta_rad)};
    const double v = dot(velocity(now, then), unit_vector(now.theta_rad));
    const double w = wrap_angle(now.theta_rad - then.theta_rad) / kFrameS;
    robot.twist = robot.twist_at_action = {static_cast<float>(v), static_cast<float>(w)};
    tracks.robots.push_back(robot);
  }
  return tracks;
}

}  // namespace touchline::hal::mock
