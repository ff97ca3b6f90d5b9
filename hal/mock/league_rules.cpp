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

Vector2 position_of(const Placement& placement) { return {placement.x_m, placement.y_m}; }

Placement turned(const RestartPlace& place, double direction) {
  return {direction * place.position.x, direction * place.position.y,
          direction > 0.0 ? place.theta_rad : wrap_angle(place.theta_rad + std::numbers::pi)};
}

RestartSizes sizes_of(const ArenaParameters& parameters) {
  const ArenaField& field = parameters.field;
  return {.length_m = field.length_m,
          .width_m = field.width_m,
          .corner_m = field.corner_m,
          .circle_radius_m = field.circle_radius_m,
          .goal_area_depth_m = parameters.rules.goal_area_depth_m,
          .goal_area_width_m = parameters.rules.goal_area_width_m,
          .robot_radius_m = parameters.robot_side_m * std::numbers::sqrt2 / 2.0,
          .ball_radius_m = parameters.ball_radius_m};
}

bool lasts(bool condition, double& time_s) {
  time_s = condition ? time_s + World::kStepS : 0.0;
  return time_s > kReactionS;
}

}  // namespace

LeagueRules::LeagueRules(const ArenaParameters& parameters)
    : rules_(sizes_of(parameters)), limit_s_(parameters.physics.free_ball_after_s) {}

std::optional<RestartOrder> LeagueRules::judge(const World& world, double still_s) {
  for (const Side side : {Side::kOwn, Side::kOpponent}) {
    if (const std::optional<RestartOrder> order = judge_area(world, side)) return order;
  }
  const bool is_in_area = rules_.in_goal_area(world.ball()) || rules_.in_goal_area(-world.ball());
  if (still_s > limit_s_ && !is_in_area) return free_ball(world.ball());
  return std::nullopt;
}

std::optional<RestartOrder> LeagueRules::judge_area(const World& world, Side defender) {
  Area& area = areas_[static_cast<std::size_t>(defender)];
  const double direction = direction_of(defender);
  if (!rules_.in_goal_area(direction * world.ball())) {
    area = {};
    return std::nullopt;
  }
  const Snapshot all = world.snapshot();
  int defenders = 0, attackers = 0;
  for (std::size_t i = 0; i < all.robots.size(); ++i) {
    if (!rules_.in_goal_area(direction * position_of(all.robots[i]))) continue;
    ++(world.side(i) == defender ? defenders : attackers);
  }
  area.ball_s += World::kStepS;
  if (lasts(defenders > 1, area.defenders_s)) return penalty(defender);
  if (lasts(attackers > 1, area.attackers_s)) return goal_kick(other_side(defender), world.ball());
  if (area.ball_s <= limit_s_) return std::nullopt;
  return attackers > 0 ? goal_kick(other_side(defender), world.ball()) : penalty(defender);
}

RestartOrder LeagueRules::free_ball(Vector2 ball) const {
  return {Restart::kFreeBall, std::nullopt, std::nullopt, rules_.free_ball_mark(ball)};
}

RestartOrder LeagueRules::penalty(Side foul_of) const {
  const Side kicker = other_side(foul_of);
  return {Restart::kPenalty, kicker, foul_of, direction_of(kicker) * rules_.penalty_mark()};
}

RestartOrder LeagueRules::goal_kick(Side foul_of, Vector2 ball) const {
  const Side side = other_side(foul_of);
  // At the edge of the goal area, on the side where the ball was.
  const Vector2 place{-direction_of(side) * (0.5 * rules_.sizes().length_m - rules_.sizes().goal_area_depth_m),
                      std::copysign(0.25 * rules_.sizes().goal_area_width_m, ball.y)};
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
  players.goalkeeper = nearest({-direction_of(side) * 0.5 * rules_.sizes().length_m, 0.0}, std::nullopt);
  const bool takes_part = !order.side || *order.side == side;
  if (takes_part) {
    players.taker = order.restart == Restart::kGoalKick ? players.goalkeeper : nearest(order.ball, players.goalkeeper);
    if (!players.taker) players.taker = players.goalkeeper;  // the only robot
  }
  return players;
}

/// Finds places for all robots, those that are certain first.
class LeagueRules::Placing {
 public:
  Placing(const LeagueRules& league, const RestartOrder& order, const World& world, const Snapshot& from, bool fixes,
          Snapshot& out)
      : league_(league),
        rules_(league.rules_),
        order_(order),
        world_(world),
        from_(from),
        fixes_(fixes),
        players_{league.players_of(Side::kOwn, world, from, order),
                 league.players_of(Side::kOpponent, world, from, order)},
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
  [[nodiscard]] bool is_taker(std::size_t robot) const { return robot == team_of(robot).taker; }
  [[nodiscard]] RestartPart part_of(std::size_t robot) const {
    return {order_.side == world_.side(robot), robot == team_of(robot).goalkeeper, is_taker(robot)};
  }
  // In the coordinates of the robot's team.
  [[nodiscard]] Vector2 ball_for(std::size_t robot) const { return direction_of(robot) * order_.ball; }
  [[nodiscard]] const Players& team_of(std::size_t robot) const {
    return players_[static_cast<std::size_t>(world_.side(robot))];
  }
  [[nodiscard]] double direction_of(std::size_t robot) const { return league_.direction_of(world_.side(robot)); }

  bool fix(std::size_t robot) {
    const auto fixed = rules_.fixed_place(order_.restart, part_of(robot), ball_for(robot));
    if (fixed) out_.robots[robot] = turned(*fixed, direction_of(robot));
    return fixed.has_value();
  }

  [[nodiscard]] bool is_possible(std::size_t robot, Vector2 place) const {
    if (!rules_.is_legal(order_.restart, part_of(robot), ball_for(robot), direction_of(robot) * place)) return false;
    // A robot that drove to where it is may be beside another one, a wall or the ball.
    const bool stays = distance(place, position_of(from_.robots[robot])) == 0.0;
    if (!stays && !rules_.is_on_field(place)) return false;
    const bool drove = stays && !fixes_;
    if (distance(place, order_.ball) < rules_.reach_m() && !(drove && is_taker(robot))) return false;
    const double least = drove ? 0.0 : 2.0 * rules_.sizes().robot_radius_m + RestartRules::kGapM;
    for (std::size_t k = 0; k < from_.robots.size(); ++k) {
      if (k != robot && (placed_ >> k & 1U) != 0 && distance(place, position_of(out_.robots[k])) < least) return false;
    }
    return true;
  }

  bool move(std::size_t robot) {
    const auto place = rules_.nearest_place(position_of(from_.robots[robot]), direction_of(robot),
                                            [&](Vector2 candidate) { return is_possible(robot, candidate); });
    if (place) out_.robots[robot] = {place->x, place->y, bearing(order_.ball - *place)};
    return place.has_value();  // without one, the robot stays
  }

  const LeagueRules& league_;
  const RestartRules& rules_;
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
