#include "hal/mock/strategies/team_roles.h"

#include <limits>

namespace touchline::hal::mock {
namespace {

bool plays(const Players& players, RobotId id) {
  for (const Player& player : players) {
    if (player.id == id) return true;
  }
  return false;
}

// Returns the player with the least cost, except `other`.
template <class Cost>
RobotId cheapest(const Players& players, RobotId other, Cost cost) {
  RobotId chosen = kUnknownId;
  double least = std::numeric_limits<double>::max();
  for (const Player& player : players) {
    if (player.id == other) continue;
    const double c = cost(player);
    if (c >= least) continue;
    least = c;
    chosen = player.id;
  }
  return chosen;
}

}  // namespace

void TeamRoles::assign(const Players& players, int goalkeeper_id, Vector2 own_goal, const Vector2* ball) {
  if (goalkeeper_id >= 0) {
    goalkeeper_ = static_cast<RobotId>(goalkeeper_id);
  } else if (players.size() < 2) {
    goalkeeper_ = kUnknownId;
  } else if (!plays(players, goalkeeper_)) {
    goalkeeper_ =
        cheapest(players, kUnknownId, [&](const Player& player) { return distance(position(player.pose), own_goal); });
  }
  if (ball == nullptr) {
    attacker_ = kUnknownId;
    return;
  }
  attacker_ = cheapest(players, goalkeeper_, [&](const Player& player) {
    // A robot in front of the ball must drive around it. The attacker stays unless another robot is clearly nearer.
    constexpr double kAround = 0.2, kHysteresis = 0.15;
    const Vector2 p = position(player.pose);
    return distance(p, *ball) + (p.x > ball->x ? kAround : 0.0) - (player.id == attacker_ ? kHysteresis : 0.0);
  });
}

PlayRole TeamRoles::role_of(RobotId id) const {
  if (id == kUnknownId) return PlayRole::kNone;
  if (id == goalkeeper_) return PlayRole::kGoalkeeper;
  return id == attacker_ ? PlayRole::kAttacker : PlayRole::kSupporter;
}

std::size_t TeamRoles::rank_of(RobotId id, const Players& players) const {
  std::size_t rank = 0;
  for (const Player& player : players) {
    if (player.id < id && player.id != goalkeeper_ && player.id != attacker_) ++rank;
  }
  return rank;
}

}  // namespace touchline::hal::mock
