#include "core/marker/rigid_fit.h"

#include <cmath>

#include "core/geometry/angle.h"
#include "core/marker/simd4.h"

namespace touchline {

namespace {

// Relative rounding error of residual_squares(), which subtracts nearly equal squares. It exceeds the real error even
// for points several meters from the origin.
constexpr float kErrorOfSquares = 1e-4f;

// Moments of the points that determine the pose: their means, and sums over their deviations from the means.
struct Moments {
  // Coordinates of layout and seen points, x and y each.
  using Both = Simd4<float>;
  static_assert(sizeof(Correspondence) == sizeof(Both));

  Both mean{}, squares{};
  float along = 0, across = 0;  // sums of scalar and vector products

  explicit Moments(std::span<const Correspondence> points) {
    const float n = static_cast<float>(points.size());
    for (const Correspondence& p : points) mean += __builtin_bit_cast(Both, p) / n;
    for (const Correspondence& p : points) {
      const Both d = __builtin_bit_cast(Both, p) - mean;
      squares += d * d;
      along += d[0] * d[2] + d[1] * d[3];
      across += d[0] * d[3] - d[1] * d[2];
    }
  }

  // Computes the rotation that maximizes the sum of the scalar products (Procrustes in the plane).
  [[nodiscard]] RigidFit fit(std::span<const Correspondence> points) const {
    const FieldPoint place{mean[0], mean[1]}, seen{mean[2], mean[3]};
    RigidFit fit;
    fit.pose.theta_rad = wrap_angle(std::atan2(across, along));
    const float length = std::sqrt(along * along + across * across);
    // If all points coincide, the direction is undefined.
    const float c = length > 0.0f ? along / length : 1.0f, s = length > 0.0f ? across / length : 0.0f;
    fit.pose.position = {seen.x_m - (c * place.x_m - s * place.y_m), seen.y_m - (s * place.x_m + c * place.y_m)};
    float sum = 0;
    for (const Correspondence& p : points) {
      const float x = p.seen.x_m - fit.pose.position.x_m, y = p.seen.y_m - fit.pose.position.y_m;
      const float ex = c * x + s * y - p.place.x_m, ey = c * y - s * x - p.place.y_m;
      sum += ex * ex + ey * ey;
    }
    fit.residual_m = std::sqrt(sum / static_cast<float>(points.size()));
    return fit;
  }

  // Returns a lower bound of the sum of the squared distances after the best rotation.
  [[nodiscard]] float residual_squares() const {
    const float sum = sum_of_lanes(squares);
    return sum - 2 * std::sqrt(along * along + across * across) - kErrorOfSquares * sum;
  }
};

}  // namespace

RobotFrame::RobotFrame(const Pose& pose)
    : origin_(pose.position), c_(std::cos(pose.theta_rad)), s_(std::sin(pose.theta_rad)) {}

RigidFit fit_rigidly(std::span<const Correspondence> points) { return Moments(points).fit(points); }

bool fit_rigidly_within(float most_m, std::span<const Correspondence> points, RigidFit& fit) {
  const Moments moments(points);
  if (moments.residual_squares() > most_m * most_m * static_cast<float>(points.size())) return false;
  fit = moments.fit(points);
  return fit.residual_m <= most_m;
}

PoseCovariance to_field(const PoseCovariance& own, float theta_rad) {
  const float c = std::cos(theta_rad), s = std::sin(theta_rad);
  return {c * c * own.xx - 2 * c * s * own.xy + s * s * own.yy,
          s * s * own.xx + 2 * c * s * own.xy + c * c * own.yy,
          own.tt,
          c * s * (own.xx - own.yy) + (c * c - s * s) * own.xy,
          c * own.xt - s * own.yt,
          s * own.xt + c * own.yt};
}

PoseCovariance rigid_fit_noise(std::span<const FieldPoint> places, std::span<const PointCovariance> errors,
                               float theta_rad) {
  const float n = static_cast<float>(places.size());
  FieldPoint mean{};
  for (const FieldPoint& p : places) {
    mean.x_m += p.x_m / n;
    mean.y_m += p.y_m / n;
  }
  float squares = 0;
  for (const FieldPoint& p : places) {
    const float x = p.x_m - mean.x_m, y = p.y_m - mean.y_m;
    squares += x * x + y * y;
  }
  // To first order, the heading's error is the sum of t . e over all points' errors e, where t is perpendicular to the
  // lever arm. The position's error is the mean of e, minus the displacement of the center by the rotation about the
  // points' mean.
  PoseCovariance own;  // in the robot's frame
  for (std::size_t k = 0; k < places.size(); ++k) {
    const float tx = (mean.y_m - places[k].y_m) / squares, ty = (places[k].x_m - mean.x_m) / squares;
    const float ax = 1 / n + mean.y_m * tx, ay = mean.y_m * ty;
    const float bx = -mean.x_m * tx, by = 1 / n - mean.x_m * ty;
    const PointCovariance& e = errors[k];
    const auto product = [&e](float px, float py, float qx, float qy) {
      return px * qx * e.xx + (px * qy + py * qx) * e.xy + py * qy * e.yy;
    };
    own.xx += product(ax, ay, ax, ay);
    own.yy += product(bx, by, bx, by);
    own.tt += product(tx, ty, tx, ty);
    own.xy += product(ax, ay, bx, by);
    own.xt += product(ax, ay, tx, ty);
    own.yt += product(bx, by, tx, ty);
  }
  return to_field(own, theta_rad);
}

}  // namespace touchline
