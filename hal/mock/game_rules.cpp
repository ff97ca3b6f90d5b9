#include "hal/mock/game_rules.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include "hal/mock/fnv1a.h"

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

std::size_t index_of(Side side) { return static_cast<std::size_t>(side); }

}  // namespace

GameRules::GameRules(const ArenaParameters& parameters, World& world, std::uint64_t seed)
    : goal_line_m_(0.5 * parameters.field.length_m + parameters.ball_radius_m),
      reach_m_(parameters.robot_side_m * std::numbers::sqrt2 / 2.0 + parameters.ball_radius_m),
      free_ball_after_s_(parameters.physics.free_ball_after_s),
      quarter_{0.25 * parameters.field.length_m, 0.25 * parameters.field.width_m},
      returns_robots_(parameters.robots_return),
      world_(world),
      start_(world.snapshot()),
      random_(seed, kRulesStream) {
  kick_off();
}

void GameRules::place_ball(const Placement& placement, Vector2 velocity_mps) {
  world_.place_ball(placement, velocity_mps);
  still_at_ = ball_before_ = world_.ball();
  still_s_ = 0.0;
}

void GameRules::return_robots() {
  for (std::size_t i = 0; i < start_.robots.size(); ++i) world_.place(i, start_.robots[i]);
}

void GameRules::restart(std::uint64_t seed) {
  random_ = Random(seed, kRulesStream);
  statistics_ = {};
  touches_ball_ = 0;
  last_contact_ = {};
  kick_off();
}

void GameRules::kick_off() {
  if (returns_robots_) {
    return_robots();
    stopped_steps_ = kStoppedSteps;
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
}

void GameRules::update() {
  if (stopped_steps_ > 0) {
    // As if somebody held them: commands of the former game are still on their way.
    return_robots();
    --stopped_steps_;
  }
  statistics_.ball_path_m += length(world_.ball() - ball_before_);
  ball_before_ = world_.ball();
  count_touches();
  count_contacts();
  if (possession_) statistics_.possession_s[index_of(*possession_)] += World::kStepS;
  watch_goals();
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
    ++(x > 0.0 ? statistics_.goals_own : statistics_.goals_opponent);
    kick_off();
    return;
  }
  watch_standing();
}

void GameRules::watch_standing() {
  if (length(world_.ball() - still_at_) > kStillM) {
    still_at_ = world_.ball();
    still_s_ = 0.0;
    return;
  }
  // If nobody drives a robot, the ball stays where somebody has put it.
  if (!world_.is_driven()) return;
  const double before = still_s_;
  still_s_ += World::kStepS;
  if (still_s_ > GameStatistics::kStandingS) {
    statistics_.ball_stood_s += before > GameStatistics::kStandingS ? World::kStepS : still_s_;
  }
  if (still_s_ > free_ball_after_s_) {
    ++statistics_.free_balls;
    kick_off();
  }
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
  Random ahead = random_;
  fnv.add(ahead.bits());
  return fnv.value();
}

}  // namespace touchline::hal::mock
