#include "hal/mock/game_rules.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include "core/geometry/angle.h"
#include "hal/fnv1a.h"

namespace touchline::hal::mock {
namespace {

constexpr std::uint64_t kRulesStream = 6;
// A ball that has moved less than this is regarded as stationary.
constexpr double kStillM = 0.05;
// Two robots that touch again after a shorter gap never parted: bodies that push each other lose contact for some
// steps.
constexpr std::uint64_t kApartSteps = 100;
// A second: long enough for trackers to find robots that were put elsewhere.
constexpr int kStoppedSteps = 1000;
// While robots drive to their places: time between two looks at them, and the least time, in which they begin to move.
constexpr double kLineUpCheckS = 0.5, kLineUpLeastS = 1.0;
// A robot that has moved less between two looks stands.
constexpr double kStandsM = 0.01;

std::size_t index_of(Side side) { return static_cast<std::size_t>(side); }

// Turns all robots by 180 degrees about the center of the field.
void turn(Snapshot& all) {
  for (Placement& robot : all.robots) {
    robot = {-robot.x_m, -robot.y_m, wrap_angle(robot.theta_rad + std::numbers::pi)};
  }
}

}  // namespace

GameRules::GameRules(const ArenaParameters& parameters, World& world, std::uint64_t seed)
    : goal_line_m_(0.5 * parameters.field.length_m + parameters.ball_radius_m),
      reach_m_(parameters.robot_side_m * std::numbers::sqrt2 / 2.0 + parameters.ball_radius_m),
      free_ball_after_s_(parameters.physics.free_ball_after_s),
      quarter_{0.25 * parameters.field.length_m, 0.25 * parameters.field.width_m},
      returns_robots_(parameters.robots_return),
      rules_(parameters.rules),
      world_(world),
      start_(world.snapshot()),
      league_(parameters),
      random_(seed, kRulesStream),
      held_(start_) {
  begin();
}

void GameRules::restart(std::uint64_t seed) {
  random_ = Random(seed, kRulesStream);
  statistics_ = {};
  touches_ball_ = 0;
  last_contact_ = {};
  steps_ = 0;
  begin();
}

void GameRules::begin() {
  half_ = 1;
  line_up_s_ = -1.0;
  stopped_steps_ = 0;
  if (league_.sides_exchanged()) league_.exchange_sides();
  held_ = start_;
  if (rules_.league == League::kSimple) {
    restart_near_center();
    return;
  }
  first_kick_off_ = random_.bernoulli(0.5) ? Side::kOwn : Side::kOpponent;
  order(LeagueRules::kick_off(first_kick_off_), true);
}

void GameRules::place_ball(const Placement& placement, Vector2 velocity_mps) {
  world_.place_ball(placement, velocity_mps);
  still_at_ = ball_before_ = world_.ball();
  still_s_ = 0.0;
}

void GameRules::place_robot(std::size_t robot, const Placement& placement) {
  world_.place(robot, placement);
  held_.robots[robot] = placement;
}

void GameRules::hold_places_of_start() {
  held_ = start_;
  if (league_.sides_exchanged()) turn(held_);
}

void GameRules::put_robots() {
  hold_robots();
  ++placements_;
  stopped_steps_ = kStoppedSteps;
}

void GameRules::hold_robots() {
  for (std::size_t i = 0; i < held_.robots.size(); ++i) world_.place(i, held_.robots[i]);
}

void GameRules::order(const RestartOrder& order, bool by_hand) {
  order_ = order;
  is_untouched_ = true;
  ++restarts_;
  ++statistics_.restarts[static_cast<std::size_t>(order.restart)];
  statistics_.free_balls += order.restart == Restart::kFreeBall ? 1U : 0U;
  if (order.foul_of) ++statistics_.fouls[index_of(*order.foul_of)];
  possession_.reset();
  league_.restart();
  if (rules_.robots == RobotsAtRestart::kDrive && !by_hand) {
    line_up_s_ = 0.0;
    line_up_before_ = world_.snapshot();
  } else {
    // At a kick-off as at the start of the game.
    Snapshot from = order.restart == Restart::kKickOff ? start_ : world_.snapshot();
    if (order.restart == Restart::kKickOff && league_.sides_exchanged()) turn(from);
    league_.place(order, world_, from, true, held_);
    put_robots();
  }
  place_ball({order.ball.x, order.ball.y, 0.0});
}

void GameRules::watch_line_up() {
  world_.place_ball({order_.ball.x, order_.ball.y, 0.0});  // as if somebody held it
  const double before_s = line_up_s_;
  line_up_s_ += World::kStepS;
  if (std::floor(line_up_s_ / kLineUpCheckS) == std::floor(before_s / kLineUpCheckS)) return;
  const Snapshot now = world_.snapshot();
  bool stands = line_up_s_ > kLineUpLeastS;
  for (std::size_t i = 0; i < now.robots.size(); ++i) {
    const Placement &robot = now.robots[i], &before = line_up_before_.robots[i];
    stands = stands && length(Vector2{robot.x_m - before.x_m, robot.y_m - before.y_m}) < kStandsM;
  }
  line_up_before_ = now;
  if (!stands && line_up_s_ < rules_.line_up_s) return;
  line_up_s_ = -1.0;
  league_.place(order_, world_, now, false, held_);
  for (std::size_t i = 0; i < now.robots.size(); ++i) {
    const Placement &placed = held_.robots[i], &robot = now.robots[i];
    if (length(Vector2{placed.x_m - robot.x_m, placed.y_m - robot.y_m}) == 0.0) continue;
    world_.place(i, placed);
    ++placements_;
  }
  place_ball({order_.ball.x, order_.ball.y, 0.0});
}

void GameRules::end_half() {
  league_.exchange_sides();
  ++half_;
  line_up_s_ = -1.0;
  if (rules_.league != League::kSimple) {
    order(LeagueRules::kick_off(half_ % 2 == 0 ? other_side(first_kick_off_) : first_kick_off_), true);
    return;
  }
  hold_places_of_start();
  put_robots();
  restart_near_center();
}

void GameRules::kick_off(Side conceded) {
  if (rules_.league == League::kSimple) {
    restart_near_center();
  } else {
    order(LeagueRules::kick_off(conceded), false);
  }
}

void GameRules::restart_near_center() {
  if (returns_robots_) {
    hold_places_of_start();
    put_robots();
  }
  // Draws a random point near the center, because from a fixed point two symmetric teams could block each other
  // forever. The area grows with each draw until the point is free of robots.
  constexpr int kDraws = 200;
  const Snapshot all = world_.snapshot();
  Vector2 point;
  for (int draw = 0; draw < kDraws; ++draw) {
    const double wider = 0.2 * draw / kDraws;
    const double x = std::min(0.02 + wider, quarter_.x);
    const double y = std::min(0.05 + wider, quarter_.y);
    point = {random_.uniform(-x, x), random_.uniform(-y, y)};
    const auto is_near = [&](const Placement& robot) {
      return length(Vector2{robot.x_m, robot.y_m} - point) < reach_m_;
    };
    if (std::none_of(all.robots.begin(), all.robots.end(), is_near)) break;
  }
  place_ball({point.x, point.y, 0.0});
  possession_.reset();
  ++restarts_;
  ++statistics_.restarts[static_cast<std::size_t>(Restart::kNone)];
}

void GameRules::update() {
  if (stopped_steps_ > 0) {
    // As if somebody held them: commands of the former game are still on their way.
    hold_robots();
    --stopped_steps_;
  }
  statistics_.ball_path_m += length(world_.ball() - ball_before_);
  ball_before_ = world_.ball();
  count_touches();
  count_contacts();
  if (possession_) statistics_.possession_s[index_of(*possession_)] += World::kStepS;
  if (rules_.half_s > 0.0 && static_cast<double>(steps_) * World::kStepS >= rules_.half_s * half_) {
    end_half();
  } else if (line_up_s_ >= 0.0) {
    watch_line_up();
  } else {
    watch_goals();
  }
}

void GameRules::count_touches() {
  std::uint32_t touches = 0;
  for (std::size_t i = 0; i < world_.robots(); ++i) {
    if (!world_.touches_ball(i)) continue;
    touches |= 1U << i;
    possession_ = world_.side(i);
    if ((touches_ball_ >> i & 1U) == 0) ++statistics_.touches[index_of(world_.side(i))];
  }
  touches_ball_ = touches;
  if (touches != 0 && stopped_steps_ == 0 && line_up_s_ < 0.0) is_untouched_ = false;
}

void GameRules::count_contacts() {
  ++steps_;
  for (std::size_t i = 0; i < world_.robots(); ++i) {
    // Only robots with smaller numbers, so that each pair counts once.
    for (std::uint32_t others = world_.touching(i) & ((1U << i) - 1U); others != 0; others &= others - 1U) {
      const auto other = static_cast<std::size_t>(std::countr_zero(others));
      std::uint64_t& last = last_contact_[i][other];
      if (last == 0 || steps_ - last > kApartSteps) {
        const bool same = world_.side(i) == world_.side(other);
        ++(same ? statistics_.contacts[index_of(world_.side(i))] : statistics_.mixed_contacts);
      }
      last = steps_;
    }
  }
}

void GameRules::watch_goals() {
  const double x = world_.ball().x;
  if (std::abs(x) > goal_line_m_) {
    const Side scorer = x * league_.direction_of(Side::kOwn) > 0.0 ? Side::kOwn : Side::kOpponent;
    ++(scorer == Side::kOwn ? statistics_.goals_own : statistics_.goals_opponent);
    kick_off(other_side(scorer));
    return;
  }
  watch_standing();
}

void GameRules::watch_standing() {
  const bool has_moved = length(world_.ball() - still_at_) > kStillM;
  if (has_moved) {
    still_at_ = world_.ball();
    still_s_ = 0.0;
  }
  // If nobody drives a robot, the ball stays where somebody has put it.
  if (!world_.is_driven()) return;
  if (!has_moved) {
    const double before = still_s_;
    still_s_ += World::kStepS;
    if (still_s_ > GameStatistics::kStandingS) {
      statistics_.ball_stood_s += before > GameStatistics::kStandingS ? World::kStepS : still_s_;
    }
  }
  if (rules_.league != League::kSimple) {
    if (const std::optional<RestartOrder> ordered = league_.judge(world_, still_s_)) order(*ordered, false);
  } else if (still_s_ > free_ball_after_s_) {
    ++statistics_.free_balls;
    restart_near_center();
  }
}

GameSituation GameRules::situation(Side side) const {
  if (rules_.league == League::kSimple) return {};
  const bool ours = order_.side == side;
  if (stopped_steps_ > 0) return {GamePhase::kPrepare, order_.restart, ours, false};
  if (line_up_s_ >= 0.0) return {GamePhase::kPrepare, order_.restart, ours, true};
  if (is_untouched_) return {GamePhase::kRunning, order_.restart, ours, false};
  return {GamePhase::kRunning, Restart::kNone, false, false};
}

std::optional<RefereeState> GameRules::referee() const {
  if (rules_.league == League::kSimple && rules_.half_s == 0.0) return std::nullopt;
  RefereeState state;
  const GameSituation now = situation(Side::kOwn);
  state.phase = now.phase;
  state.restart = now.restart;
  state.restart_is_ours = now.ours;
  state.lines_up = now.lines_up;
  state.half = rules_.half_s > 0.0 ? static_cast<std::uint8_t>(std::min(half_, 255U)) : std::uint8_t{0};
  state.own_on_positive_half = league_.sides_exchanged();
  return state;
}

std::uint64_t GameRules::hash() const {
  Fnv1a fnv;
  fnv.add(world_.hash());
  for (const std::uint64_t count : statistics_.touches) fnv.add(count);
  for (const std::uint64_t count : statistics_.contacts) fnv.add(count);
  for (const double time_s : statistics_.possession_s) fnv.add(time_s);
  fnv.add(statistics_.mixed_contacts);
  fnv.add(statistics_.ball_path_m);
  fnv.add(statistics_.ball_stood_s);
  fnv.add(std::uint64_t{statistics_.goals_own});
  fnv.add(std::uint64_t{statistics_.goals_opponent});
  fnv.add(std::uint64_t{statistics_.free_balls});
  fnv.add(still_at_);
  fnv.add(still_s_);
  fnv.add(static_cast<std::uint64_t>(stopped_steps_));
  fnv.add(std::uint64_t{touches_ball_});
  for (std::size_t i = 0; i < world_.robots(); ++i) {
    for (std::size_t k = 0; k < i; ++k) fnv.add(last_contact_[i][k]);
  }
  if (rules_.league != League::kSimple || rules_.half_s > 0.0) {
    for (const std::uint32_t count : statistics_.fouls) fnv.add(std::uint64_t{count});
    for (const std::uint32_t count : statistics_.restarts) fnv.add(std::uint64_t{count});
    fnv.add(std::uint64_t{half_});
    fnv.add(order_.ball);
    fnv.add(std::uint64_t{is_untouched_});
    fnv.add(line_up_s_);
    league_.add_to(fnv);
  }
  Random ahead = random_;
  fnv.add(ahead.bits());
  return fnv.value();
}

}  // namespace touchline::hal::mock
