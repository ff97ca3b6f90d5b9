#include "core/control/restart_rules.h"

#include <algorithm>
#include <cmath>

namespace touchline {
namespace {

// Distance of the robots from the ball at a free ball, in both leagues.
constexpr double kFreeBallM = 0.2;
// Marks of the VSSS field, 1.5 m x 1.3 m: free balls at (0.375 m, 0.4 m) from the center, penalties at the same x.
constexpr double kMarkX = 0.375 / 1.5, kMarkY = 0.4 / 1.3;

}  // namespace

RestartRules::RestartRules(const RestartSizes& sizes)
    : sizes_(sizes), reach_m_(sizes.robot_radius_m + sizes.ball_radius_m + kGapM) {}

bool RestartRules::in_goal_area(Vector2 p) const {
  return p.x < -0.5 * sizes_.length_m + sizes_.goal_area_depth_m && std::abs(p.y) < 0.5 * sizes_.goal_area_width_m;
}

bool RestartRules::is_on_field(Vector2 p) const {
  const double x = std::abs(p.x), y = std::abs(p.y), half_length = 0.5 * sizes_.length_m,
               half_width = 0.5 * sizes_.width_m;
  return x <= half_length - sizes_.robot_radius_m && y <= half_width - sizes_.robot_radius_m &&
         x + y <= half_length + half_width - sizes_.corner_m - std::numbers::sqrt2 * sizes_.robot_radius_m;
}

Vector2 RestartRules::free_ball_mark(Vector2 ball) const {
  return {std::copysign(kMarkX * sizes_.length_m, ball.x), std::copysign(kMarkY * sizes_.width_m, ball.y)};
}

Vector2 RestartRules::penalty_mark() const { return {kMarkX * sizes_.length_m, 0.0}; }

std::optional<RestartPlace> RestartRules::fixed_place(Restart restart, const RestartPart& part, Vector2 ball) const {
  const double goal_line = -0.5 * sizes_.length_m, radius = sizes_.robot_radius_m;
  switch (restart) {
    case Restart::kKickOff:
    case Restart::kPenalty:
      if (part.is_taker) return RestartPlace{{ball.x - reach_m_, ball.y}, 0.0};
      if (restart == Restart::kPenalty && part.is_goalkeeper && !part.ours) {
        return RestartPlace{{goal_line + radius, 0.0}, 0.5 * std::numbers::pi};
      }
      break;
    case Restart::kFreeBall:
      if (part.is_taker) return RestartPlace{{ball.x - kFreeBallM, ball.y}, 0.0};
      break;
    case Restart::kGoalKick:
      if (part.is_taker) {
        const Vector2 away = ball - Vector2{goal_line, 0.0};
        const Vector2 place = ball - (reach_m_ / std::max(norm(away), reach_m_)) * away;
        return RestartPlace{{std::max(place.x, goal_line + radius), place.y}, bearing(away)};
      }
      break;
    default:
      break;
  }
  return std::nullopt;
}

bool RestartRules::is_legal(Restart restart, const RestartPart& part, Vector2 ball, Vector2 place) const {
  const double radius = sizes_.robot_radius_m;
  const bool in_own_half = place.x <= -radius, in_other_half = place.x >= radius;
  switch (restart) {
    case Restart::kKickOff:
      return in_own_half && (part.is_taker || distance(place, ball) >= std::max(kFreeBallM, sizes_.circle_radius_m));
    case Restart::kFreeBall:
      if (part.is_taker || (part.is_goalkeeper && in_goal_area(place))) {
        return distance(place, ball) >= kFreeBallM - kGapM;
      }
      return place.x * ball.x <= 0.0 || place.y * ball.y <= 0.0;
    case Restart::kPenalty:
      if (part.is_taker) return true;
      if (part.ours) return in_own_half;
      return part.is_goalkeeper ? place.x < -0.5 * sizes_.length_m + sizes_.goal_area_depth_m : in_other_half;
    case Restart::kGoalKick:
      if (part.is_taker) return true;
      return part.ours ? !in_goal_area(place) && distance(place, ball) >= kFreeBallM : in_own_half;
    default:
      return true;
  }
}

}  // namespace touchline
