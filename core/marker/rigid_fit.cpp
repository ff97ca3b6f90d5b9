#include "core/marker/rigid_fit.h"

#include <cmath>

#include "core/geometry/angle.h"

namespace touchline {

float distance_m(FieldPoint a, FieldPoint b) {
  const float x = a.x_m - b.x_m, y = a.y_m - b.y_m;
  return std::sqrt(x * x + y * y);
}

FieldPoint to_robot_frame(const Pose& pose, FieldPoint point) {
  const float c = std::cos(pose.theta_rad), s = std::sin(pose.theta_rad);
  const float x = point.x_m - pose.position.x_m, y = point.y_m - pose.position.y_m;
  return {c * x + s * y, c * y - s * x};
}

RigidFit fit_rigidly(std::span<const Correspondence> points) {
  const float n = static_cast<float>(points.size());
  FieldPoint place{}, seen{};
  for (const Correspondence& p : points) {
    place.x_m += p.place.x_m / n;
    place.y_m += p.place.y_m / n;
    seen.x_m += p.seen.x_m / n;
    seen.y_m += p.seen.y_m / n;
  }
  // The rotation that maximizes the sum of the scalar products (Procrustes in the plane).
  float along = 0, across = 0;
  for (const Correspondence& p : points) {
    const float ax = p.place.x_m - place.x_m, ay = p.place.y_m - place.y_m;
    const float bx = p.seen.x_m - seen.x_m, by = p.seen.y_m - seen.y_m;
    along += ax * bx + ay * by;
    across += ax * by - ay * bx;
  }
  RigidFit fit;
  fit.pose.theta_rad = wrap_angle(std::atan2(across, along));
  const float c = std::cos(fit.pose.theta_rad), s = std::sin(fit.pose.theta_rad);
  fit.pose.position = {seen.x_m - (c * place.x_m - s * place.y_m), seen.y_m - (s * place.x_m + c * place.y_m)};
  float squares = 0;
  for (const Correspondence& p : points) {
    const FieldPoint back = to_robot_frame(fit.pose, p.seen);
    const float ex = back.x_m - p.place.x_m, ey = back.y_m - p.place.y_m;
    squares += ex * ex + ey * ey;
  }
  fit.residual_m = std::sqrt(squares / n);
  return fit;
}

}  // namespace touchline
