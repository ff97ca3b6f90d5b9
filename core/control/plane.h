#pragma once

#include <cmath>

#include "core/types.h"

namespace touchline {

/// A place or a direction on the field, in meters.
struct Vector2 {
  double x = 0.0, y = 0.0;

  friend constexpr Vector2 operator+(Vector2 a, Vector2 b) { return {a.x + b.x, a.y + b.y}; }
  friend constexpr Vector2 operator-(Vector2 a, Vector2 b) { return {a.x - b.x, a.y - b.y}; }
  friend constexpr Vector2 operator*(double s, Vector2 a) { return {s * a.x, s * a.y}; }
};

constexpr double dot(Vector2 a, Vector2 b) { return a.x * b.x + a.y * b.y; }
/// Positive when b is to the left of a.
constexpr double cross(Vector2 a, Vector2 b) { return a.x * b.y - a.y * b.x; }
inline double norm(Vector2 a) { return std::hypot(a.x, a.y); }
inline double distance(Vector2 a, Vector2 b) { return norm(a - b); }
inline double bearing(Vector2 a) { return std::atan2(a.y, a.x); }
inline Vector2 direction(double angle_rad) { return {std::cos(angle_rad), std::sin(angle_rad)}; }
/// A quarter turn to the left.
constexpr Vector2 left_of(Vector2 a) { return {-a.y, a.x}; }

constexpr Vector2 vector(FieldPoint p) { return {static_cast<double>(p.x_m), static_cast<double>(p.y_m)}; }
constexpr FieldPoint field_point(Vector2 v) { return {static_cast<float>(v.x), static_cast<float>(v.y)}; }
constexpr Vector2 position(const Pose& pose) { return vector(pose.position); }
constexpr double heading(const Pose& pose) { return static_cast<double>(pose.theta_rad); }

}  // namespace touchline
