#include "tools/programs/control/drill.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "firmware/arena_sides.h"

namespace touchline::control_evaluation {

using hal::mock::Side;

namespace {

// Robots stand in rows until a drill moves them.
std::vector<hal::mock::ArenaRobot> robots_in_rows(int own, int opponents) {
  std::vector<hal::mock::ArenaRobot> robots;
  for (int i = 0; i < own + opponents; ++i) {
    hal::mock::ArenaRobot robot;
    robot.team = i < own ? Side::kOwn : Side::kOpponent;
    robot.id = i < own ? i : i - own;
    const int row = robot.id / 4;
    robot.x_m = (i < own ? -1.0 : 1.0) * (0.2 + 0.25 * row);
    robot.y_m = 0.3 * (robot.id % 4) - 0.45;
    robots.push_back(robot);
  }
  return robots;
}

// Nobody puts a resting ball elsewhere; a goal still restarts the game.
void without_rules(hal::mock::ArenaParameters& arena) { arena.physics.free_ball_after_s = 600.0; }

}  // namespace

Result<std::unique_ptr<Drill>> Drill::make(const config::Configuration& configuration, const DrillSettings& settings) {
  std::unique_ptr<Drill> drill(new Drill);
  config::Configuration changed = configuration;
  hal::mock::ArenaParameters& arena = changed.board.arena;
  without_rules(arena);
  arena.robot = robots_in_rows(settings.own, settings.opponents);
  if (settings.true_delay_s) {
    arena.radio.delay_s = *settings.true_delay_s;
    arena.radio.jitter_s = 0.0;
    changed.board.radio.delay_s = *settings.true_delay_s;
  }
  if (settings.believed_delay_s) changed.board.radio.delay_s = *settings.believed_delay_s;
  changed.board.camera.rate_hz = settings.rate_hz;
  ControlParameters& control = changed.pipeline.control;
  control.play.enabled = settings.strategy != nullptr;
  if (settings.max_speed_mps) control.drive.max_speed_mps = *settings.max_speed_mps;
  if (settings.strict) control.avoid = Avoidance::kStrict;
  drill->game_ = std::make_unique<hal::mock::Game>(arena, changed.board.radio, settings.seed);
  for (const Side side : {Side::kOwn, Side::kOpponent}) {
    hal::mock::SideSettings of_side = side_settings(changed, side);
    of_side.strategy = side == Side::kOwn ? settings.strategy : nullptr;
    auto& player = drill->sides_[static_cast<std::size_t>(side)];
    player = std::make_unique<hal::mock::SimulatedSide>(arena, side, settings.seed);
    if (const Status status = player->configure(of_side); !status.ok()) {
      return failure(status.code(), "the pipeline of a side refuses the settings");
    }
    if (side == Side::kOwn || settings.opponents > 0) drill->game_->set_side(side, player.get());
    if (side == Side::kOpponent) continue;
    constexpr std::size_t kPacketBytes = 65;  // docs/radio.md
    drill->mean_reaction_s_ = 0.5 / settings.rate_hz + seconds(of_side.frame_latency) +
                              seconds(of_side.line.of(kPacketBytes)) + arena.radio.delay_s + arena.radio.jitter_s;
  }
  drill->game_->channel(Side::kOwn).set_layouts(changed.pipeline.radio, changed.pipeline.telemetry);
  return drill;
}

void Drill::step() {
  game_->step();
  for (auto& side : sides_) {
    for (ExternalCommand& command : side->inputs().commands) command.received = game_->now() + hal::mock::Game::kStep;
  }
}

void Drill::wait(double time_s) {
  const double end = this->time_s() + time_s;
  while (this->time_s() < end) step();
}

void Drill::go(Side side, RobotId id, Vector2 place, std::optional<double> heading_rad) {
  ExternalCommand command;
  command.id = id;
  command.kind = ExternalCommand::Kind::kPose;
  command.target = {to_field_point(place), static_cast<float>(heading_rad.value_or(0.0))};
  command.has_heading = heading_rad.has_value();
  command.received = now();
  ExternalCommands& commands = side_commands(side);
  const auto former = std::find_if(commands.begin(), commands.end(), [&](const auto& one) { return one.id == id; });
  if (former != commands.end()) {
    *former = command;
  } else {
    commands.push_back(command);
  }
}

Vector2 random_place(hal::mock::Random& random, const hal::mock::ArenaParameters& arena, double margin_m) {
  const auto within = [&](double size) { return (size - 2.0 * margin_m) * (random.uniform() - 0.5); };
  const double x = within(arena.field.length_m);
  return {x, within(arena.field.width_m)};
}

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::sort(values.begin(), values.end());
  const auto at = static_cast<std::size_t>(share * static_cast<double>(values.size()));
  return values[std::min(at, values.size() - 1)];
}

}  // namespace touchline::control_evaluation
