#include "tools/programs/simulate/release_0_1/roles.h"

#include <algorithm>
#include <limits>

namespace touchline::release_0_1 {
namespace {

const Player* find(const Players& players, RobotId id) {
  for (const Player& player : players) {
    if (player.id == id) return &player;
  }
  return nullptr;
}

Vector2 inside(Vector2 p, const FieldParameters& field, double margin) {
  const double x = 0.5 * static_cast<double>(field.length_m) - margin;
  const double y = 0.5 * static_cast<double>(field.width_m) - margin;
  return {std::clamp(p.x, -x, x), std::clamp(p.y, -y, y)};
}

// Moves `p` away from `other` to a distance of at least `min_distance`.
Vector2 apart(Vector2 p, Vector2 other, double min_distance) {
  const double d = distance(p, other);
  if (d >= min_distance) return p;
  return d > 1e-6 ? other + (min_distance / d) * (p - other) : other + Vector2{-min_distance, 0.0};
}

}  // namespace

void supporter_places(const PushPlan& plan, const FieldParameters& field, const PlayParameters& play, std::size_t count,
                      Places& out) {
  const double end = 0.5 * static_cast<double>(field.length_m), side = 0.5 * static_cast<double>(field.width_m);
  const Vector2 own_goal{-end, 0.0};
  const double inner = plan.ball.y > 0.0 ? -1.0 : 1.0;
  const double width = static_cast<double>(field.width_m);
  out.clear();
  for (std::size_t i = 0; i < std::min(count, Places::capacity()); ++i) {
    Vector2 place;
    if (i == 0) {
      place = plan.ball + Vector2{-0.18 * width, 0.18 * width * inner};
    } else if (i == 1) {
      place = own_goal + 0.45 * (plan.ball - own_goal);
    } else if (i == 2) {
      place = {-0.45 * end, 0.45 * side * inner};
    } else {
      // Larger teams: two columns across the field.
      const std::size_t rank = (i - 3) / 2;
      const double row = static_cast<double>(rank), column = (i - 3) % 2 == 0 ? 0.35 : -0.7;
      place = {column * end, inner * side * (0.7 - 0.45 * row)};
    }
    // Keep a distance to the goalkeeper, the ball and the other places.
    place.x = std::max(place.x, -end + play.keeper_line_m + 2.0 * play.clearance_m);
    place = apart(place, plan.ball, 2.0 * play.clearance_m);
    for (const Vector2& other : out) place = apart(place, other, 1.5 * play.clearance_m);
    out.push_back(inside(place, field, play.clearance_m));
  }
}

void Roles::reset() {
  goalkeeper_ = attacker_ = kUnknownId;
  places_.clear();
  held_ = 0;
}

void Roles::assign(const Players& players, const PushPlan* plan, const FieldParameters& field,
                   const PlayParameters& play) {
  choose_goalkeeper(players, field, play);
  if (plan == nullptr) {
    attacker_ = kUnknownId;
    places_.clear();
    held_ = 0;
    return;
  }
  choose_attacker(players, *plan, play);
  std::size_t supporters = 0;
  for (const Player& p : players) supporters += p.id != goalkeeper_ && p.id != attacker_ ? 1 : 0;
  supporter_places(*plan, field, play, supporters, places_);
  choose_supporters(players, play);
}

void Roles::choose_goalkeeper(const Players& players, const FieldParameters& field, const PlayParameters& play) {
  if (play.goalkeeper_id >= 0) {
    goalkeeper_ = static_cast<RobotId>(play.goalkeeper_id);
    return;
  }
  if (find(players, goalkeeper_) != nullptr) return;
  goalkeeper_ = kUnknownId;
  const Vector2 goal{-0.5 * static_cast<double>(field.length_m), 0.0};
  double best = std::numeric_limits<double>::max();
  for (const Player& player : players) {
    const double d = distance(position(player.pose), goal);
    if (d >= best) continue;
    best = d;
    goalkeeper_ = player.id;
  }
}

void Roles::choose_attacker(const Players& players, const PushPlan& plan, const PlayParameters& play) {
  RobotId chosen = kUnknownId;
  double best = std::numeric_limits<double>::max();
  for (const Player& player : players) {
    if (player.id == goalkeeper_) continue;
    // Use the distance to the place behind the ball as the cost. A robot in front of the ball has to drive around it.
    const Vector2 from_ball = position(player.pose) - plan.ball;
    double cost = distance(position(player.pose), plan.behind);
    if (dot(from_ball, plan.direction) > 0.0) cost += play.behind_ball_m;
    if (player.id == attacker_) cost -= play.attacker_hysteresis_m;
    if (cost >= best) continue;
    best = cost;
    chosen = player.id;
  }
  attacker_ = chosen;
}

void Roles::choose_supporters(const Players& players, const PlayParameters& play) {
  const std::array<RobotId, kMaxRobotsPerTeam> before = holder_;
  const std::size_t held = held_;
  std::array<bool, kMaxRobotsPerTeam> placed{};
  // The most important place takes the nearest robot first.
  for (std::size_t k = 0; k < places_.size(); ++k) {
    double best = std::numeric_limits<double>::max();
    std::size_t chosen = players.size();
    for (std::size_t i = 0; i < players.size(); ++i) {
      if (placed[i] || players[i].id == goalkeeper_ || players[i].id == attacker_) continue;
      double cost = distance(position(players[i].pose), places_[k]);
      if (k < held && before[k] == players[i].id) cost -= play.slot_hysteresis_m;
      if (cost >= best) continue;
      best = cost;
      chosen = i;
    }
    if (chosen == players.size()) continue;
    placed[chosen] = true;
    holder_[k] = players[chosen].id;
  }
  held_ = places_.size();
}

const Vector2* Roles::place_of(RobotId id) const {
  for (std::size_t k = 0; k < held_; ++k) {
    if (holder_[k] == id) return &places_[k];
  }
  return nullptr;
}

PlayRole Roles::role_of(RobotId id) const {
  if (id == goalkeeper_) return PlayRole::kGoalkeeper;
  if (id == attacker_) return PlayRole::kAttacker;
  return place_of(id) != nullptr ? PlayRole::kSupporter : PlayRole::kNone;
}

}  // namespace touchline::release_0_1
