#include "hal/mock/strategies/univector.h"

#include <algorithm>

namespace touchline::hal::mock {

Twist Univector::move(const Player& player, const Scene& scene) {
  if (!scene.ball_known) return {};
  if (player.id == roles().attacker()) return attack(player, scene, Avoid::kRobots);
  return go_to(player, scene, place_of(roles().rank_of(player.id, scene.players), scene.ball));
}

Vector2 Univector::place_of(std::size_t rank, Vector2 ball) const {
  const double inner = ball.y > 0.0 ? -1.0 : 1.0;
  Vector2 place;
  if (rank == 0) {
    place = ball + Vector2{-0.35 * scale(), 0.1 * scale() * inner};  // UnBrain's midfielder: 0.35 m behind the ball
  } else if (rank == 1) {
    place = own_goal() + 0.4 * (ball - own_goal());
  } else {
    // Two columns across the own half.
    const std::size_t pair = (rank - 2) / 2;
    const double row = static_cast<double>(pair), side = rank % 2 == 0 ? inner : -inner;
    place = {-half_length_m() * (0.35 + 0.1 * row), side * half_width_m() * (0.65 - 0.15 * row)};
  }
  place.x = std::max(place.x, -half_length_m() + static_cast<double>(field().goal_width_m));
  return inside(place, 3.0 * radius_m());
}

}  // namespace touchline::hal::mock
