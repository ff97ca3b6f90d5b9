#pragma once

#include <cmath>

#include "core/types.h"

namespace touchline {

/// A point or a vector in the plane. On the field: meters, x towards the opponent's goal, y to the left.
struct Vector2 {
  double x = 0.0, y = 0.0;

  friend constexpr Vector2 operator+(Vector2 a, Vector2 b) { return {a.x + b.x, a.y + b.y}; }
  friend constexpr Vector2 operator-(Vector2 a, Vector2 b) { return {a.x - b.x, a.y - b.y}; }
  friend constexpr Vector2 operator-(Vector2 a) { return {-a.x, -a.y}; }
  friend constexpr Vector2 operator*(double s, Vector2 a) { return {s * a.x, s * a.y}; }
};

constexpr double dot(Vector2 a, Vector2 b) { return a.x * b.x + a.y * b.y; }
/// Positive when b is to the left of a.
constexpr double cross(Vector2 a, Vector2 b) { return a.x * b.y - a.y * b.x; }
inline double norm(Vector2 a) { return std::hypot(a.x, a.y); }
inline double distance(Vector2 a, Vector2 b) { return norm(a - b); }
/// Angle from the x axis, counter-clockwise, in [-pi, pi].
inline double bearing(Vector2 a) { return std::atan2(a.y, a.x); }
inline Vector2 unit_vector(double angle_rad) { return {std::cos(angle_rad), std::sin(angle_rad)}; }
/// The vector rotated by 90 degrees counter-clockwise.
constexpr Vector2 perpendicular(Vector2 a) { return {-a.y, a.x}; }
/// The vector rotated counter-clockwise.
inline Vector2 rotated(Vector2 a, double angle_rad) {
  const double c = std::cos(angle_rad), s = std::sin(angle_rad);
  return {c * a.x - s * a.y, s * a.x + c * a.y};
}

constexpr Vector2 to_vector(FieldPoint p) { return {static_cast<double>(p.x_m), static_cast<double>(p.y_m)}; }
constexpr FieldPoint to_field_point(Vector2 v) { return {static_cast<float>(v.x), static_cast<float>(v.y)}; }
constexpr Vector2 position(const Pose& pose) { return to_vector(pose.position); }
constexpr double heading(const Pose& pose) { return static_cast<double>(pose.theta_rad); }

}  // namespace touchline
