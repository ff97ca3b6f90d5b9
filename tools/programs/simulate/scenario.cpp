#include "tools/programs/simulate/scenario.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "hal/mock/game.h"
#include "hal/mock/random.h"
#include "tools/programs/command_line/formatted.h"

namespace touchline::simulate {
namespace {

using hal::mock::ArenaParameters;
using hal::mock::ArenaRobot;
using hal::mock::Game;
using hal::mock::Random;
using hal::mock::Side;

constexpr std::uint64_t kScenarioStream = 40;
constexpr Duration kFrame = std::chrono::milliseconds(10);
constexpr double kStruckMps = 0.5;

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

ArenaParameters arena_with(const Team& team, const ArenaRobot& robot) {
  ArenaParameters arena = team.configuration->board.arena;
  arena.robot = {robot};
  arena.robots_return = false;
  return arena;
}

// The game with its own side; the player must outlive the game.
void connect(const Team& team, Player& player, Game& game) {
  game.channel(Side::kOwn).set_layouts(team.configuration->pipeline.radio, team.configuration->pipeline.telemetry);
  game.set_side(Side::kOwn, player.side.get());
}

// Velocity of the ball in the last kFrame.
Vector2 advance(Game& game, Vector2& before) {
  game.advance_to(game.now() + kFrame);
  const Vector2 now = game.world().ball();
  const Vector2 velocity = (1.0 / seconds(kFrame)) * (now - before);
  before = now;
  return velocity;
}

bool crosses_goal(Vector2 ball, Vector2 velocity, const ArenaParameters& arena) {
  if (velocity.x <= 0.0) return false;
  const double y = ball.y + (0.5 * arena.field.length_m - ball.x) / velocity.x * velocity.y;
  return std::abs(y) < 0.5 * arena.field.goal_width_m - arena.ball_radius_m;
}

// The ball somewhere, near a wall or not, outside the goal areas' width at the end walls.
Vector2 resting_place(Random& random, const ArenaParameters& arena, double wall_m) {
  const double end = 0.5 * arena.field.length_m - arena.ball_radius_m - 0.001;
  const double side = 0.5 * arena.field.width_m - arena.ball_radius_m - 0.001;
  if (wall_m <= 0.0) return {random.uniform(0.12 - end, end - 0.12), random.uniform(0.12 - side, side - 0.12)};
  // Outside the corner pieces.
  const double sign = random.uniform(-1.0, 1.0) < 0.0 ? -1.0 : 1.0, off = random.uniform(0.0, wall_m);
  const double free = arena.field.corner_m + 0.05;
  if (random.uniform(-1.0, 1.0) < 0.0) return {random.uniform(free - end, end - free), sign * (side - off)};
  const double y = random.uniform(0.5 * arena.field.goal_width_m + 0.05, side - free);
  return {random.uniform(-1.0, 1.0) < 0.0 ? off - end : end - off, sign * y};
}

// Time in which a resting ball shall be in the goal.
constexpr double kScoreS = 6.0;

Result<std::array<ArenaRobot, 2>> two_own_robots(const ArenaParameters& board) {
  std::vector<ArenaRobot> own;
  for (const ArenaRobot& robot : board.robot) {
    if (robot.team == Side::kOwn) own.push_back(robot);
  }
  if (own.size() >= 2) return std::array{own[0], own[1]};
  return failure(ErrorCode::kInconsistent, "--scenarios needs two own robots; the board file has %zu", own.size());
}

struct Strike {
  double at_s = -1.0, speed_mps = 0.0;
  bool towards_goal = false, scored = false;
};

Result<Strike> play_strike(const Team& team, std::uint64_t seed, double wall_m) {
  const ArenaParameters& board = team.configuration->board.arena;
  Random random(seed, kScenarioStream);
  const Vector2 ball = resting_place(random, board, wall_m);
  TOUCHLINE_TRY_ASSIGN(const auto own, two_own_robots(board));
  ArenaRobot robot = own[0];
  do {
    robot.x_m = random.uniform(-0.75, 0.9) * 0.5 * board.field.length_m;
    robot.y_m = random.uniform(-0.85, 0.85) * 0.5 * board.field.width_m;
  } while (std::hypot(robot.x_m - ball.x, robot.y_m - ball.y) < 0.15);
  robot.theta_rad = random.uniform(-1.0, 1.0) * std::numbers::pi;
  ArenaRobot keeper = own[1];
  keeper.x_m = -0.5 * board.field.length_m + 0.05;
  keeper.y_m = 0.0;
  keeper.theta_rad = 0.5 * std::numbers::pi;
  ArenaParameters arena = arena_with(team, robot);
  arena.robot.push_back(keeper);
  TOUCHLINE_TRY_ASSIGN(Player player, make_player(team, arena, Side::kOwn, seed));
  Game game(arena, team.configuration->board.radio, seed);
  game.rules().place_ball({ball.x, ball.y, 0.0});
  connect(team, player, game);
  Strike strike;
  Vector2 before = ball;
  constexpr double kAfterS = 0.3;
  const std::uint32_t begun = game.rules().restarts();
  for (double t = 0.0; t < kScoreS; t += seconds(kFrame)) {
    const Vector2 velocity = advance(game, before);
    if (game.statistics().goals_own > 0) {
      strike.scored = true;
      break;
    }
    if (game.rules().restarts() != begun) break;  // an own goal, or a free ball
    const double speed = std::hypot(velocity.x, velocity.y);
    if (strike.at_s < 0.0 && speed >= kStruckMps) strike.at_s = t;
    if (strike.at_s < 0.0 || t > strike.at_s + kAfterS) continue;
    if (speed <= strike.speed_mps) continue;
    strike.speed_mps = speed;
    strike.towards_goal = crosses_goal(game.world().ball(), velocity, arena);
  }
  return strike;
}

// How far a robot drives from rest in this time.
double reach_m(double time_s, const DriveParameters& drive) {
  const double ramp_s = drive.max_speed_mps / drive.max_wheel_acceleration_mps2;
  const double t = std::max(0.0, time_s);
  return t < ramp_s ? 0.5 * drive.max_wheel_acceleration_mps2 * t * t : drive.max_speed_mps * (t - 0.5 * ramp_s);
}

enum class ShotResult { kUnreachable, kSaved, kScored };

Result<ShotResult> play_shot(const Team& team, std::uint64_t seed) {
  const ArenaParameters& board = team.configuration->board.arena;
  Random random(seed, kScenarioStream);
  const double end = 0.5 * board.field.length_m, mouth = 0.5 * board.field.goal_width_m - board.ball_radius_m;
  const Vector2 from{-end + random.uniform(0.5, 1.2), random.uniform(-0.5, 0.5)};
  const Vector2 aim{-end, random.uniform(-mouth, mouth)};
  const double speed = random.uniform(0.6, 1.6);
  TOUCHLINE_TRY_ASSIGN(const auto own, two_own_robots(board));
  ArenaRobot robot = own[0];
  robot.x_m = -end + 0.08;
  robot.y_m = 0.0;
  robot.theta_rad = 0.5 * std::numbers::pi;
  ArenaRobot other = robot;  // so that the first one keeps the goal
  other.id = own[1].id;
  other.colors = own[1].colors;
  other.x_m = 0.8 * end;
  ArenaParameters arena = arena_with(team, robot);
  arena.robot.push_back(other);
  TOUCHLINE_TRY_ASSIGN(Player player, make_player(team, arena, Side::kOwn, seed));
  Game game(arena, team.configuration->board.radio, seed);
  connect(team, player, game);
  // First the goalkeeper takes its place for a ball that lies there.
  game.rules().place_ball({from.x, from.y, 0.0});
  game.advance_to(game.now() + std::chrono::milliseconds(1200));
  const Vector2 way = aim - from;
  const double length = std::hypot(way.x, way.y);
  game.rules().place_ball({from.x, from.y, 0.0}, (speed / length) * way);
  const auto keeper = game.world().snapshot().robots[0];
  // Seen and commanded after 0.1 s (camera, processing, radio, lag of the wheels); the ball slows down by a fifth.
  const double time = (length - 0.1) / (0.9 * speed) - 0.1;
  const double line_y = aim.y + (way.y / length) * -0.08;
  const double missing = std::abs(line_y - keeper.y_m) - 0.5 * board.robot_side_m - 0.5 * board.ball_radius_m;
  if (missing > reach_m(time, team.configuration->pipeline.control.drive)) return ShotResult::kUnreachable;
  game.advance_to(game.now() + from_seconds(2.0 * length / speed));
  return game.statistics().goals_opponent > 0 ? ShotResult::kScored : ShotResult::kSaved;
}

}  // namespace

Result<RestingBall> play_resting_ball(const Team& team, int trials, double wall_m) {
  RestingBall all;
  all.trials = trials;
  std::vector<double> times, speeds;
  constexpr double kSoonS = 2.0;
  for (int i = 1; i <= trials; ++i) {
    TOUCHLINE_TRY_ASSIGN(const Strike strike, play_strike(team, static_cast<std::uint64_t>(i), wall_m));
    const bool soon = strike.at_s >= 0.0 && strike.at_s < kSoonS;
    all.struck += soon ? 1 : 0;
    all.towards_goal += soon && strike.towards_goal ? 1 : 0;
    all.scored += strike.scored ? 1 : 0;
    times.push_back(strike.at_s < 0.0 ? kScoreS : strike.at_s);
    if (strike.at_s >= 0.0) speeds.push_back(strike.speed_mps);
  }
  all.strike_s = median(times);
  all.speed_mps = median(speeds);
  return all;
}

Result<Shots> play_shots(const Team& team, int trials) {
  Shots all;
  all.trials = trials;
  for (int i = 1; i <= trials; ++i) {
    TOUCHLINE_TRY_ASSIGN(const ShotResult result, play_shot(team, static_cast<std::uint64_t>(i)));
    all.reachable += result != ShotResult::kUnreachable ? 1 : 0;
    all.saved += result == ShotResult::kSaved ? 1 : 0;
  }
  return all;
}

Result<std::string> scenario_text(const Team& team, int trials) {
  std::string text;
  for (const double wall_m : {0.0, 0.03}) {
    TOUCHLINE_TRY_ASSIGN(const RestingBall ball, play_resting_ball(team, trials, wall_m));
    text += formatted(
        "resting ball %s: struck within 2 s %d of %d, towards the goal %d, scored within 6 s %d; median %.2f s, %.2f "
        "m/s\n",
        wall_m > 0.0 ? "at a wall" : "in the field", ball.struck, ball.trials, ball.towards_goal, ball.scored,
        ball.strike_s, ball.speed_mps);
  }
  TOUCHLINE_TRY_ASSIGN(const Shots shots, play_shots(team, trials));
  return text +
         formatted("goalkeeper: saved %d of %d reachable shots, of %d\n", shots.saved, shots.reachable, shots.trials);
}

}  // namespace touchline::simulate
