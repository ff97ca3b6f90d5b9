#include "hal/mock/strategies/wall.h"

#include <algorithm>
#include <cmath>

#include "hal/mock/strategies/drive_law.h"

namespace touchline::hal::mock {

// The point at which the line from the goal leaves the goal area, enlarged by a robot; without a goal area, a rectangle
// as deep as the goal is wide.
Vector2 Wall::center_of_wall(Vector2 towards) const {
  const FieldParameters& f = field();
  const bool has_area = f.penalty_area_depth_m > 0.0f && f.penalty_area_width_m > 0.0f;
  const double size = 2.0 * radius_m();
  const double depth = has_area ? static_cast<double>(f.penalty_area_depth_m) + size : 2.0 * half_goal_m();
  const double half = has_area ? 0.5 * static_cast<double>(f.penalty_area_width_m) + size : 2.0 * half_goal_m();
  const double to_front = towards.x > 1e-6 ? depth / towards.x : 1e6;
  const double to_side = std::abs(towards.y) > 1e-6 ? half / std::abs(towards.y) : 1e6;
  return own_goal() + std::min(to_front, to_side) * towards;
}

Twist Wall::move(const Player& player, const Scene& scene) {
  if (!scene.ball_known) return {};
  if (player.id == roles().attacker()) return attack(player, scene, Avoid::kNothing);
  Vector2 towards = scene.ball - own_goal();
  towards.x = std::max(towards.x, 0.0);
  if (norm(towards) < 1e-6) towards = {1.0, 0.0};
  towards = (1.0 / norm(towards)) * towards;
  const Vector2 across = perpendicular(towards), center = center_of_wall(towards);

  // The robots stand in the order in which they are now, so they do not pass each other.
  const Vector2 here = position(player.pose);
  std::size_t count = 0, rank = 0;
  for (const Player& other : scene.players) {
    if (other.id == roles().goalkeeper() || other.id == roles().attacker()) continue;
    ++count;
    const double off = dot(position(other.pose) - here, across);
    if (off < 0.0 || (off == 0.0 && other.id < player.id)) ++rank;
  }
  const double gap = 0.02;  // m; a golf ball has a diameter of 43 mm
  const double offset = static_cast<double>(rank) - 0.5 * static_cast<double>(count - 1);
  const Vector2 place = inside(center + (offset * (2.0 * radius_m() + gap)) * across, radius_m() + gap);

  const double line = bearing(across);
  if (distance(here, place) < 0.4 * radius_m()) return turn_along(player.pose, line);
  if (std::abs(dot(place - here, towards)) > radius_m())
    return drive_to(player.pose, place, stopping_law(max_speed_mps()));
  return drive_along(player.pose, place, line, stopping_law(max_speed_mps()));
}

}  // namespace touchline::hal::mock
