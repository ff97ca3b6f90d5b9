#include "hal/mock/league_rules.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/geometry/angle.h"

namespace touchline::hal::mock {
namespace {

// Time for which too many robots are in a goal area with the ball before it counts: a person needs about as long to see
// it, and a robot that only passes is no foul.
constexpr double kReactionS = 0.5;
// Distance of the robots from the ball at a free ball, in both leagues.
constexpr double kFreeBallM = 0.2;
// Gap between bodies that are placed beside each other.
constexpr double kGapM = 0.01;
// Marks of the VSSS field, 1.5 m x 1.3 m: free balls at (0.375 m, 0.4 m) from the center, penalties at the same x.
constexpr double kMarkX = 0.375 / 1.5, kMarkY = 0.4 / 1.3;

Vector2 position_of(const Placement& placement) { return {placement.x_m, placement.y_m}; }

Placement turned(const Placement& place, double direction) {
  return {direction * place.x_m, direction * place.y_m,
          direction > 0.0 ? place.theta_rad : wrap_angle(place.theta_rad + std::numbers::pi)};
}

bool lasts(bool condition, double& time_s) {
  time_s = condition ? time_s + World::kStepS : 0.0;
  return time_s > kReactionS;
}

}  // namespace

LeagueRules::LeagueRules(const ArenaParameters& parameters)
    : field_(parameters.field),
      rules_(parameters.rules),
      radius_m_(parameters.robot_side_m * std::numbers::sqrt2 / 2.0),
      reach_m_(radius_m_ + parameters.ball_radius_m + kGapM),
      limit_s_(parameters.physics.free_ball_after_s) {}

bool LeagueRules::in_goal_area(Vector2 p) const {
  return p.x < -0.5 * field_.length_m + rules_.goal_area_depth_m && std::abs(p.y) < 0.5 * rules_.goal_area_width_m;
}

std::optional<RestartOrder> LeagueRules::judge(const World& world, double still_s) {
  for (const Side side : {Side::kOwn, Side::kOpponent}) {
    if (const std::optional<RestartOrder> order = judge_area(world, side)) return order;
  }
  const bool is_in_area = in_goal_area(world.ball()) || in_goal_area(-world.ball());
  if (still_s > limit_s_ && !is_in_area) return free_ball(world.ball());
  return std::nullopt;
}

std::optional<RestartOrder> LeagueRules::judge_area(const World& world, Side defender) {
  Area& area = areas_[static_cast<std::size_t>(defender)];
  const double direction = direction_of(defender);
  if (!in_goal_area(direction * world.ball())) {
    area = {};
    return std::nullopt;
  }
  const Snapshot all = world.snapshot();
  int defenders = 0, attackers = 0;
  for (std::size_t i = 0; i < all.robots.size(); ++i) {
    if (!in_goal_area(direction * position_of(all.robots[i]))) continue;
    ++(world.side(i) == defender ? defenders : attackers);
  }
  area.ball_s += World::kStepS;
  if (lasts(defenders > 1, area.defenders_s)) return penalty(defender);
  if (lasts(attackers > 1, area.attackers_s)) return goal_kick(other_side(defender), world.ball());
  if (area.ball_s <= limit_s_) return std::nullopt;
  return attackers > 0 ? goal_kick(other_side(defender), world.ball()) : penalty(defender);
}

RestartOrder LeagueRules::free_ball(Vector2 ball) const {
  const Vector2 mark{std::copysign(kMarkX * field_.length_m, ball.x), std::copysign(kMarkY * field_.width_m, ball.y)};
  return {Restart::kFreeBall, std::nullopt, std::nullopt, mark};
}

RestartOrder LeagueRules::penalty(Side foul_of) const {
  const Side kicker = other_side(foul_of);
  return {Restart::kPenalty, kicker, foul_of, {direction_of(kicker) * kMarkX * field_.length_m, 0.0}};
}

RestartOrder LeagueRules::goal_kick(Side foul_of, Vector2 ball) const {
  const Side side = other_side(foul_of);
  // At the edge of the goal area, on the side where the ball was.
  const Vector2 place{-direction_of(side) * (0.5 * field_.length_m - rules_.goal_area_depth_m),
                      std::copysign(0.25 * rules_.goal_area_width_m, ball.y)};
  return {Restart::kGoalKick, side, foul_of, place};
}

LeagueRules::Players LeagueRules::players_of(Side side, const World& world, const Snapshot& from,
                                             const RestartOrder& order) const {
  const auto nearest = [&](Vector2 point, std::optional<std::size_t> except) {
    std::optional<std::size_t> best;
    for (std::size_t i = 0; i < from.robots.size(); ++i) {
      if (world.side(i) != side || i == except) continue;
      if (!best || distance(position_of(from.robots[i]), point) < distance(position_of(from.robots[*best]), point)) {
        best = i;
      }
    }
    return best;
  };
  Players players;
  players.goalkeeper = nearest({-direction_of(side) * 0.5 * field_.length_m, 0.0}, std::nullopt);
  const bool takes_part = !order.side || *order.side == side;
  if (takes_part) {
    players.taker = order.restart == Restart::kGoalKick ? players.goalkeeper : nearest(order.ball, players.goalkeeper);
    if (!players.taker) players.taker = players.goalkeeper;  // the only robot
  }
  return players;
}

std::optional<Placement> LeagueRules::fixed_place(const RestartOrder& order, Side side, bool is_goalkeeper,
                                                  bool is_taker) const {
  const Vector2 ball = direction_of(side) * order.ball;
  switch (order.restart) {
    case Restart::kKickOff:
    case Restart::kPenalty:
      if (is_taker) return Placement{ball.x - reach_m_, ball.y, 0.0};
      if (order.restart == Restart::kPenalty && is_goalkeeper && order.side != side) {
        return Placement{-0.5 * field_.length_m + radius_m_, 0.0, 0.5 * std::numbers::pi};
      }
      break;
    case Restart::kFreeBall:
      if (is_taker) return Placement{ball.x - kFreeBallM, ball.y, 0.0};
      break;
    case Restart::kGoalKick:
      if (is_taker) {
        const Vector2 away = ball - Vector2{-0.5 * field_.length_m, 0.0};
        const Vector2 place = ball - (reach_m_ / std::max(norm(away), reach_m_)) * away;
        return Placement{std::max(place.x, -0.5 * field_.length_m + radius_m_), place.y, bearing(away)};
      }
      break;
    default:
      break;
  }
  return std::nullopt;
}

bool LeagueRules::is_legal(const RestartOrder& order, Side side, bool is_goalkeeper, bool is_taker,
                           Vector2 place) const {
  const Vector2 ball = direction_of(side) * order.ball;
  const bool takes = order.side == side;
  const bool in_own_half = place.x <= -radius_m_, in_other_half = place.x >= radius_m_;
  switch (order.restart) {
    case Restart::kKickOff:
      return in_own_half && (is_taker || distance(place, ball) >= std::max(kFreeBallM, field_.circle_radius_m));
    case Restart::kFreeBall:
      if (is_taker || (is_goalkeeper && in_goal_area(place))) return distance(place, ball) >= kFreeBallM - kGapM;
      return place.x * ball.x <= 0.0 || place.y * ball.y <= 0.0;
    case Restart::kPenalty:
      if (is_taker) return true;
      if (takes) return in_own_half;
      return is_goalkeeper ? place.x < -0.5 * field_.length_m + rules_.goal_area_depth_m : in_other_half;
    case Restart::kGoalKick:
      if (is_taker) return true;
      return takes ? !in_goal_area(place) && distance(place, ball) >= kFreeBallM : in_own_half;
    default:
      return true;
  }
}

bool LeagueRules::is_on_field(Vector2 p) const {
  const double x = std::abs(p.x), y = std::abs(p.y), half_length = 0.5 * field_.length_m,
               half_width = 0.5 * field_.width_m;
  return x <= half_length - radius_m_ && y <= half_width - radius_m_ &&
         x + y <= half_length + half_width - field_.corner_m - std::numbers::sqrt2 * radius_m_;
}

/// Finds places for all robots, those that are certain first.
class LeagueRules::Placing {
 public:
  Placing(const LeagueRules& rules, const RestartOrder& order, const World& world, const Snapshot& from, bool fixes,
          Snapshot& out)
      : rules_(rules),
        order_(order),
        world_(world),
        from_(from),
        fixes_(fixes),
        players_{rules.players_of(Side::kOwn, world, from, order),
                 rules.players_of(Side::kOpponent, world, from, order)},
        out_(out) {
    out_ = from;
    out_.ball = {order.ball.x, order.ball.y, 0.0};
    for_each([this](std::size_t i) { return fixes_ && fix(i); });
    for_each([this](std::size_t i) { return is_possible(i, position_of(from_.robots[i])); });
    for_each([this](std::size_t i) { return move(i); });
  }

 private:
  // Calls `place` for each robot that has no place yet; it returns whether the robot has one now.
  template <class Place>
  void for_each(const Place& place) {
    for (std::size_t i = 0; i < from_.robots.size(); ++i) {
      if ((placed_ >> i & 1U) == 0 && place(i)) placed_ |= 1U << i;
    }
  }
  [[nodiscard]] bool is_goalkeeper(std::size_t robot) const { return robot == team_of(robot).goalkeeper; }
  [[nodiscard]] bool is_taker(std::size_t robot) const { return robot == team_of(robot).taker; }
  [[nodiscard]] const Players& team_of(std::size_t robot) const {
    return players_[static_cast<std::size_t>(world_.side(robot))];
  }
  [[nodiscard]] double direction_of(std::size_t robot) const { return rules_.direction_of(world_.side(robot)); }

  bool fix(std::size_t robot) {
    const auto fixed = rules_.fixed_place(order_, world_.side(robot), is_goalkeeper(robot), is_taker(robot));
    if (fixed) out_.robots[robot] = turned(*fixed, direction_of(robot));
    return fixed.has_value();
  }

  [[nodiscard]] bool is_possible(std::size_t robot, Vector2 place) const {
    if (!rules_.is_legal(order_, world_.side(robot), is_goalkeeper(robot), is_taker(robot),
                         direction_of(robot) * place)) {
      return false;
    }
    // A robot that drove to where it is may be beside another one, a wall or the ball.
    const bool stays = distance(place, position_of(from_.robots[robot])) == 0.0;
    if (!stays && !rules_.is_on_field(place)) return false;
    const bool drove = stays && !fixes_;
    if (distance(place, order_.ball) < rules_.reach_m_ && !(drove && is_taker(robot))) return false;
    const double least = drove ? 0.0 : 2.0 * rules_.radius_m_ + kGapM;
    for (std::size_t k = 0; k < from_.robots.size(); ++k) {
      if (k != robot && (placed_ >> k & 1U) != 0 && distance(place, position_of(out_.robots[k])) < least) return false;
    }
    return true;
  }

  // Searches on circles around the robot for the nearest possible place.
  bool move(std::size_t robot) {
    constexpr int kDirections = 24;
    const double step = 0.5 * rules_.radius_m_, farthest = rules_.field_.length_m + rules_.field_.width_m;
    const Vector2 here = position_of(from_.robots[robot]);
    for (double way = step; way < farthest; way += step) {
      for (int k = 0; k < kDirections; ++k) {
        const double angle = 2.0 * std::numbers::pi * k / kDirections;
        const Vector2 place = here + (direction_of(robot) * way) * unit_vector(angle);
        if (!is_possible(robot, place)) continue;
        out_.robots[robot] = {place.x, place.y, bearing(order_.ball - place)};
        return true;
      }
    }
    return false;  // there is none: the robot stays
  }

  const LeagueRules& rules_;
  const RestartOrder& order_;
  const World& world_;
  const Snapshot& from_;
  const bool fixes_;
  const std::array<Players, 2> players_;  // by Side
  Snapshot& out_;
  std::uint32_t placed_ = 0;  // bits of the robots
};

void LeagueRules::place(const RestartOrder& order, const World& world, const Snapshot& from, bool fixes,
                        Snapshot& out) const {
  const Placing placing(*this, order, world, from, fixes, out);
}

void LeagueRules::add_to(Fnv1a& hash) const {
  hash.add(std::uint64_t{exchanged_});
  for (const Area& area : areas_) {
    hash.add(area.ball_s);
    hash.add(area.defenders_s);
    hash.add(area.attackers_s);
  }
}

}  // namespace touchline::hal::mock
