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
  // Find the first radius at which the slope is too small. Scan first, because the slope may fall and rise again; then
  // bisect.
  constexpr int kSteps = 1000 * static_cast<int>(kMaxRadius);
  constexpr double kStep = kMaxRadius / kSteps;
  for (int step = 1; step < kSteps; ++step) {
    const double r = step * kStep;
    if (polynomial_slope(r, k1, k2, k3) >= kMinSlope) continue;
    double low = r - kStep, high = r;
    for (int i = 0; i < 40; ++i) {
      const double middle = 0.5 * (low + high);
      (polynomial_slope(middle, k1, k2, k3) >= kMinSlope ? low : high) = middle;
    }
    limit_ = low;
    break;
  }
  radius_at_limit_ = polynomial(limit_, k1, k2, k3);
  slope_at_limit_ = std::max(kMinSlope, polynomial_slope(limit_, k1, k2, k3));
  // Ideal radii in a picture are well below 1. Beyond 1, the last guess of the table is used.
  const double largest_square = std::min(radius_at_limit_ * radius_at_limit_, 1.0);
  guesses_per_square_ = static_cast<double>(kGuesses) / largest_square;
  for (std::size_t i = 0; i <= kGuesses; ++i) {
    const double distorted = std::sqrt(static_cast<double>(i) / guesses_per_square_);
    guess_[i] = i == 0 ? 1.0 : ideal_radius(distorted, distorted) / distorted;
  }
}

BrownDistortion::Point BrownDistortion::tangential_inside(Point ideal, double square) const {
  const auto [x, y] = ideal;
  const double twice_xy = 2 * x * y;
  return {p1_ * twice_xy + p2_ * (square + 2 * x * x), p1_ * (square + 2 * y * y) + p2_ * twice_xy};
}

// Within the limit no square root is needed.
BrownDistortion::Point BrownDistortion::inside(Point ideal, double square) const {
  const double scale = 1.0 + square * (k1_ + square * (k2_ + square * k3_));
  const Point aside = tangential_inside(ideal, square);
  return {scale * ideal[0] + aside[0], scale * ideal[1] + aside[1]};
}

BrownDistortion::Jacobian BrownDistortion::jacobian(Point ideal, double square) const {
  const auto [x, y] = ideal;
  const double scale = 1.0 + square * (k1_ + square * (k2_ + square * k3_));
  const double twice_by_square = 2 * (k1_ + square * (2 * k2_ + square * 3 * k3_));
  return {scale + twice_by_square * x * x + 2 * p1_ * y + 6 * p2_ * x,
          twice_by_square * x * y + 2 * p1_ * x + 2 * p2_ * y,
          scale + twice_by_square * y * y + 6 * p1_ * y + 2 * p2_ * x};
}

double BrownDistortion::radial(double r) const {
  return r <= limit_ ? polynomial(r, k1_, k2_, k3_) : radius_at_limit_ + slope_at_limit_ * (r - limit_);
}

double BrownDistortion::radial_slope(double r) const {
  return r <= limit_ ? polynomial_slope(r, k1_, k2_, k3_) : slope_at_limit_;
}

double BrownDistortion::ideal_radius(double distorted, double guess) const {
  if (distorted >= radius_at_limit_) return limit_ + (distorted - radius_at_limit_) / slope_at_limit_;
  // Newton's method, kept inside an interval that contains the solution. It always converges because the radial part is
  // strictly increasing.
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
  // Beyond the limit, keep the value at the limit, because this term grows with the square of the radius.
  const double r = std::hypot(ideal[0], ideal[1]);
  const double keep = r > limit_ ? limit_ / r : 1.0;
  const double x = keep * ideal[0], y = keep * ideal[1];
  return tangential_inside({x, y}, x * x + y * y);
}

double BrownDistortion::stretch(Point ideal) const {
  const double square = ideal[0] * ideal[0] + ideal[1] * ideal[1];
  if (!(square <= limit_ * limit_)) return 0.0;
  const Jacobian s = jacobian(ideal, square);
  return s.xx * s.yy - s.xy * s.xy;
}

BrownDistortion::Point BrownDistortion::distort(Point ideal) const {
  const double square = ideal[0] * ideal[0] + ideal[1] * ideal[1];
  if (square <= limit_ * limit_) return inside(ideal, square);
  const double r = std::hypot(ideal[0], ideal[1]);
  const double scale = radial(r) / r;
  const Point t = tangential(ideal);
  return {scale * ideal[0] + t[0], scale * ideal[1] + t[1]};
}

// Solves for both coordinates with Newton's method, from a guess with an error of a few thousandths. Returns false if
// an iterate leaves the circle of the limit or the iteration does not converge.
bool BrownDistortion::undistort_by_newton(Point distorted, Point& ideal) const {
  // Convergence is quadratic: the error after a step is about the square of the step.
  constexpr double kConverged = 3e-6 * 3e-6;
  const double place = (distorted[0] * distorted[0] + distorted[1] * distorted[1]) * guesses_per_square_;
  const std::size_t below = place < static_cast<double>(kGuesses) ? static_cast<std::size_t>(place) : kGuesses - 1;
  const double part = std::min(place - static_cast<double>(below), 1.0);
  const double guess = guess_[below] + part * (guess_[below + 1] - guess_[below]);
  double x = guess * distorted[0], y = guess * distorted[1];
  const Point aside = tangential_inside({x, y}, x * x + y * y);
  x -= guess * aside[0];
  y -= guess * aside[1];
  for (int i = 0; i < 6; ++i) {
    const double square = x * x + y * y;
    if (!(square <= limit_ * limit_)) return false;
    const Point there = inside({x, y}, square);
    const Jacobian s = jacobian({x, y}, square);
    const double determinant = s.xx * s.yy - s.xy * s.xy;
    if (!(determinant > 0.0)) return false;
    const double inverse = 1.0 / determinant, u = distorted[0] - there[0], v = distorted[1] - there[1];
    const double dx = inverse * (s.yy * u - s.xy * v), dy = inverse * (s.xx * v - s.xy * u);
    x += dx;
    y += dy;
    if (dx * dx + dy * dy > kConverged) continue;
    ideal = {x, y};
    return x * x + y * y <= limit_ * limit_;
  }
  return false;
}

BrownDistortion::Point BrownDistortion::undistort(Point distorted) const {
  Point ideal = distorted;
  if (undistort_by_newton(distorted, ideal)) return ideal;
  // Fallback: iterate on the tangential part, which is small and smooth, and solve the radial part exactly in each
  // iteration. The error shrinks by a factor of about 4 |p| r / slope.
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
