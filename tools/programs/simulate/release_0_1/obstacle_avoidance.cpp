#include "tools/programs/simulate/release_0_1/obstacle_avoidance.h"

#include <cmath>

namespace touchline::release_0_1 {

void obstacles_for(RobotId id, const Tracks& tracks, Obstacles& out) {
  out.clear();
  for (const RobotTrack& robot : tracks.robots) {
    if (robot.team == Team::kOwn && robot.id == id) continue;
    out.push_back(position(robot.pose_at_action));
  }
}

Vector2 detour(Vector2 from, Vector2 target, const Obstacles& obstacles, double clearance_m,
               const FieldParameters& field) {
  const Vector2 way = target - from;
  const double length = norm(way);
  if (length < 1e-6) return target;
  const Vector2 ahead = (1.0 / length) * way;
  const Vector2* blocking = nullptr;
  double nearest = length;
  for (const Vector2& obstacle : obstacles) {
    const double along = dot(obstacle - from, ahead), beside = cross(ahead, obstacle - from);
    if (along <= 0.0 || along >= nearest || std::abs(beside) >= clearance_m) continue;
    if (distance(obstacle, target) < clearance_m) continue;
    nearest = along;
    blocking = &obstacle;
  }
  if (blocking == nullptr) return target;
  // Pass on the side that is farther from the obstacle, unless it is outside the field.
  const double side = cross(ahead, *blocking - from) > 0.0 ? -1.0 : 1.0;
  constexpr double kMargin = 1.1;  // slightly more than the clearance
  const Vector2 offset = (kMargin * side * clearance_m) * perpendicular(ahead);
  const Vector2 here = *blocking + offset, there = *blocking - offset;
  const auto inside = [&field, clearance_m](Vector2 p) {
    const double margin = 0.5 * clearance_m;
    return std::abs(p.x) < 0.5 * static_cast<double>(field.length_m) - margin &&
           std::abs(p.y) < 0.5 * static_cast<double>(field.width_m) - margin;
  };
  return inside(here) || !inside(there) ? here : there;
}

}  // namespace touchline::release_0_1
