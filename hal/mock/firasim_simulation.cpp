#include "hal/mock/firasim_simulation.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace touchline::hal::mock {

FirasimSimulation::FirasimSimulation(const ArenaParameters& parameters, std::uint64_t seed)
    : parameters_(parameters),
      world_(parameters, seed),
      rules_(parameters, world_, seed),
      before_(world_.snapshot()),
      now_(before_) {}

FirasimTeam FirasimSimulation::team_of(Side side) const {
  const bool own_is_yellow = parameters_.own_color == "yellow";
  return (side == Side::kOwn) == own_is_yellow ? FirasimTeam::kYellow : FirasimTeam::kBlue;
}

Result<void> FirasimSimulation::receive(std::span<const std::byte> packet) {
  FirasimPacket received;
  TOUCHLINE_TRY(decode_firasim(packet, received));
  for (const FirasimCommand& command : received.commands) {
    const bool exists = std::any_of(parameters_.robot.begin(), parameters_.robot.end(), [&](const ArenaRobot& robot) {
      return robot.team == side_of(command.team) && robot.id == command.id;
    });
    if (!exists) {
      ++ignored_;
      continue;
    }
    world_.drive(command.id, command.left_radps * kWheelRadius_m, command.right_radps * kWheelRadius_m,
                 side_of(command.team));
  }
  if (received.ball) {
    rules_.place_ball({received.ball->x_m, received.ball->y_m, 0.0},
                      Vector2{received.ball->vx_mps, received.ball->vy_mps});
  }
  for (const FirasimPlacement& placement : received.placements) place(placement);
  return {};
}

void FirasimSimulation::place(const FirasimPlacement& placement) {
  for (std::size_t i = 0; i < parameters_.robot.size(); ++i) {
    const ArenaRobot& robot = parameters_.robot[i];
    if (robot.id != placement.id || team_of(robot.team) != placement.team) continue;
    world_.place(i, {placement.x_m, placement.y_m, placement.theta_rad});
    return;
  }
  ++ignored_;
}

void FirasimSimulation::step() {
  before_ = now_;
  for (int i = 0; i < static_cast<int>(std::lround(kStepS / World::kStepS)); ++i) {
    world_.step();
    rules_.update();
  }
  now_ = world_.snapshot();
  ++steps_;
}

std::size_t FirasimSimulation::publish(std::span<std::byte> out) const {
  FirasimEnvironment environment;
  environment.step = steps_;
  environment.field = {parameters_.field.length_m, parameters_.field.width_m, parameters_.field.goal_width_m,
                       parameters_.field.goal_depth_m};
  environment.ball = FirasimBall{now_.ball.x_m, now_.ball.y_m, (now_.ball.x_m - before_.ball.x_m) / kStepS,
                                 (now_.ball.y_m - before_.ball.y_m) / kStepS};
  for (std::size_t i = 0; i < now_.robots.size(); ++i) {
    const Placement &at = now_.robots[i], &from = before_.robots[i];
    const ArenaRobot& robot = parameters_.robot[i];
    environment.robots[static_cast<std::size_t>(team_of(robot.team))].push_back(
        {static_cast<RobotId>(robot.id), at.x_m, at.y_m, at.theta_rad, (at.x_m - from.x_m) / kStepS,
         (at.y_m - from.y_m) / kStepS, std::remainder(at.theta_rad - from.theta_rad, 2.0 * std::numbers::pi) / kStepS});
  }
  const GameStatistics& game = rules_.statistics();
  environment.goals[static_cast<std::size_t>(team_of(Side::kOwn))] = game.goals_own;
  environment.goals[static_cast<std::size_t>(team_of(Side::kOpponent))] = game.goals_opponent;
  return encode_firasim(environment, out);
}

}  // namespace touchline::hal::mock
