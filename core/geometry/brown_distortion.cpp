#include "core/geometry/brown_distortion.h"

#include <algorithm>
#include <cmath>

namespace touchline {
namespace {

double polynomial(double r, double k1, double k2, double k3) {
  const double s = r * r;
  return r * (1.0 + s * (k1 + s * (k2 + s * k3)));
}

double polynomial_slope(double r, double k1, double k2, double k3) {
  const double s = r * r;
  return 1.0 + s * (3.0 * k1 + s * (5.0 * k2 + s * 7.0 * k3));
}

}  // namespace

BrownDistortion::BrownDistortion(double k1, double k2, double k3, double p1, double p2)
    : k1_(k1), k2_(k2), k3_(k3), p1_(p1), p2_(p2) {
  // First radius at which the slope is too small: a scan, because the slope may dip and rise again, then bisection.
  constexpr int kSteps = 1000 * static_cast<int>(kLargestRadius);
  constexpr double kStep = kLargestRadius / kSteps;
  for (int step = 1; step < kSteps; ++step) {
    const double r = step * kStep;
    if (polynomial_slope(r, k1, k2, k3) >= kLeastSlope) continue;
    double low = r - kStep, high = r;
    for (int i = 0; i < 40; ++i) {
      const double middle = 0.5 * (low + high);
      (polynomial_slope(middle, k1, k2, k3) >= kLeastSlope ? low : high) = middle;
    }
    limit_ = low;
    break;
  }
  radius_at_limit_ = polynomial(limit_, k1, k2, k3);
  slope_at_limit_ = std::max(kLeastSlope, polynomial_slope(limit_, k1, k2, k3));
}

double BrownDistortion::radial(double r) const {
  return r <= limit_ ? polynomial(r, k1_, k2_, k3_) : radius_at_limit_ + slope_at_limit_ * (r - limit_);
}

double BrownDistortion::radial_slope(double r) const {
  return r <= limit_ ? polynomial_slope(r, k1_, k2_, k3_) : slope_at_limit_;
}

double BrownDistortion::ideal_radius(double distorted, double guess) const {
  if (distorted >= radius_at_limit_) return limit_ + (distorted - radius_at_limit_) / slope_at_limit_;
  // Newton's steps, kept inside a bracket: the radial part rises everywhere, so this cannot miss.
  double low = 0.0, high = limit_;
  double r = std::clamp(guess, low, high);
  for (int i = 0; i < 50; ++i) {
    const double error = radial(r) - distorted;
    (error > 0 ? high : low) = r;
    double next = r - error / radial_slope(r);
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    if (std::abs(next - r) < 1e-13) return next;
    r = next;
  }
  return r;
}

BrownDistortion::Point BrownDistortion::tangential(Point ideal) const {
  // Held at its value on the limit: it grows with the square of the radius.
  const double r = std::hypot(ideal[0], ideal[1]);
  const double keep = r > limit_ ? limit_ / r : 1.0;
  const double x = keep * ideal[0], y = keep * ideal[1], s = x * x + y * y;
  return {2 * p1_ * x * y + p2_ * (s + 2 * x * x), p1_ * (s + 2 * y * y) + 2 * p2_ * x * y};
}

BrownDistortion::Point BrownDistortion::distort(Point ideal) const {
  const double r = std::hypot(ideal[0], ideal[1]);
  const double scale = r > 0 ? radial(r) / r : 1.0;
  const Point t = tangential(ideal);
  return {scale * ideal[0] + t[0], scale * ideal[1] + t[1]};
}

BrownDistortion::Point BrownDistortion::undistort(Point distorted) const {
  // The tangential part is small and smooth, so iterating on it alone converges, by a factor of about 4 |p| r / slope;
  // the radial part is solved exactly in every turn.
  Point ideal = distorted;
  double r = std::hypot(ideal[0], ideal[1]);
  for (int i = 0; i < 60; ++i) {
    const Point t = tangential(ideal);
    const double x = distorted[0] - t[0], y = distorted[1] - t[1];
    const double d = std::hypot(x, y);
    r = ideal_radius(d, r);
    const double scale = d > 0 ? r / d : 1.0;
    const Point next{scale * x, scale * y};
    const double change = std::abs(next[0] - ideal[0]) + std::abs(next[1] - ideal[1]);
    ideal = next;
    if (change < 1e-11) break;
  }
  return ideal;
}

}  // namespace touchline
