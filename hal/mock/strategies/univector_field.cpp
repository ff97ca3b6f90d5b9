#include "hal/mock/strategies/univector_field.h"

#include <cmath>
#include <limits>
#include <numbers>

namespace touchline::hal::mock {
namespace {

constexpr double kQuarterTurn = 0.5 * std::numbers::pi;

// Unit vector of the hyperbolic spiral around the origin. `sign`: 1: it turns counter-clockwise, -1: clockwise.
Vector2 spiral(Vector2 from_center, double sign, const FieldTarget& target) {
  const double rho = norm(from_center), radius = target.radius_m;
  const double turn =
      rho > radius ? 2.0 - (radius + target.transition_m) / (rho + target.transition_m) : std::sqrt(rho / radius);
  return unit_vector(bearing(from_center) + sign * kQuarterTurn * turn);
}

}  // namespace

double direction_to_target(Vector2 p, const FieldTarget& target) {
  // x in the target's direction, y to its left.
  const Vector2 q = rotated(p - target.place, -target.direction_rad);
  const double radius = target.radius_m;
  const auto left = [&] { return spiral({q.x, q.y - radius}, 1.0, target); };
  const auto right = [&] { return spiral({q.x, q.y + radius}, -1.0, target); };
  Vector2 direction;
  if (target.spirals == Spirals::kLeft || (target.spirals == Spirals::kBoth && q.y > radius)) {
    direction = left();
  } else if (target.spirals == Spirals::kRight || q.y < -radius) {
    direction = right();
  } else {
    direction = (q.y + radius) * left() + (radius - q.y) * right();
  }
  return bearing(direction) + target.direction_rad;
}

double avoiding_direction(Vector2 p, double direction_rad, Vector2 velocity, std::span<const MovingObstacle> obstacles,
                          const AvoidanceParameters& parameters) {
  double nearest = std::numeric_limits<double>::max();
  Vector2 away;
  for (const MovingObstacle& obstacle : obstacles) {
    const Vector2 shift = parameters.lead_s * (obstacle.velocity - velocity);
    const double way = distance(p, obstacle.position), length = norm(shift);
    // The shifted obstacle does not pass the robot.
    const Vector2 shifted = obstacle.position + (length > way ? way / length : 1.0) * shift;
    const double d = distance(p, shifted);
    if (d >= nearest) continue;
    nearest = d;
    away = d > 0.0 ? (1.0 / d) * (p - shifted) : Vector2{};
  }
  if (away.x == 0.0 && away.y == 0.0) return direction_rad;
  const double off = (nearest - parameters.min_distance_m) / parameters.width_m;
  const double weight = off <= 0.0 ? 1.0 : std::exp(-0.5 * off * off);
  return bearing(weight * away + (1.0 - weight) * unit_vector(direction_rad));
}

}  // namespace touchline::hal::mock
