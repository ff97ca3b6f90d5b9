#include "hal/mock/lens.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace touchline::hal::mock {
namespace {

double dot3(const Vec3& a, const Vec3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Vec3 cross3(const Vec3& a, const Vec3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Vec3 unit(const Vec3& a) {
  const double norm = std::sqrt(dot3(a, a));
  return {a[0] / norm, a[1] / norm, a[2] / norm};
}
Vec3 linear_combination(const Vec3& a, double s, const Vec3& b, double t) {
  return {s * a[0] + t * b[0], s * a[1] + t * b[1], s * a[2] + t * b[2]};
}

}  // namespace

Lens::Lens(const LensParameters& parameters)
    : focal_(parameters.focal_px),
      cubic_(parameters.cubic),
      // largest angle: pi (straight back), or the angle at which the radius reaches its maximum
      max_angle_rad_(cubic_ < 0.0 ? std::min(std::numbers::pi, std::sqrt(-1.0 / (3.0 * cubic_))) : std::numbers::pi),
      center_{parameters.center_u_px, parameters.center_v_px},
      position_(parameters.position_m) {
  const Vec3 forward = unit({parameters.aim_m[0] - position_[0], parameters.aim_m[1] - position_[1], -position_[2]});
  // The image's down direction is the field's -y, projected to be orthogonal to the optical axis.
  const Vec3 right = unit(cross3({0.0, -1.0, 0.0}, forward));
  const Vec3 down = cross3(forward, right);
  const double c = std::cos(parameters.roll_rad), s = std::sin(parameters.roll_rad);
  rotation_ = {linear_combination(right, c, down, s), linear_combination(right, -s, down, c), forward};
}

std::array<double, 2> Lens::project(Vec3 point_m) const {
  const Vec3 away{point_m[0] - position_[0], point_m[1] - position_[1], point_m[2] - position_[2]};
  const double x = dot3(rotation_[0], away), y = dot3(rotation_[1], away), z = dot3(rotation_[2], away);
  const double off_axis = std::hypot(x, y);
  if (off_axis <= 0.0) return center_;
  const double angle = std::min(std::atan2(off_axis, z), max_angle_rad_);
  const double radius = focal_ * (angle + cubic_ * angle * angle * angle);
  return {center_[0] + radius * x / off_axis, center_[1] + radius * y / off_axis};
}

Vec3 Lens::unproject(double u_px, double v_px) const {
  const double x = u_px - center_[0], y = v_px - center_[1];
  const double radius = std::hypot(x, y);
  // Newton's method with bisection as the fallback: the radius is monotonic, so each step shrinks the bracket.
  double low = 0.0, high = max_angle_rad_;
  double angle = std::min(radius / focal_, high);
  for (int i = 0; i < 60 && high - low > 1e-14; ++i) {
    const double error = angle + cubic_ * angle * angle * angle - radius / focal_;
    (error > 0.0 ? high : low) = angle;
    const double next = angle - error / (1.0 + 3.0 * cubic_ * angle * angle);
    if (std::abs(next - angle) < 1e-14) break;
    angle = next > low && next < high ? next : 0.5 * (low + high);
  }
  const double scale = radius > 0.0 ? std::sin(angle) / radius : 0.0;
  const Vec3 local{scale * x, scale * y, std::cos(angle)};
  Vec3 out{};
  for (std::size_t i = 0; i < 3; ++i) {
    out[i] = rotation_[0][i] * local[0] + rotation_[1][i] * local[1] + rotation_[2][i] * local[2];
  }
  return out;
}

}  // namespace touchline::hal::mock
