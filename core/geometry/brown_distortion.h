#pragma once

#include <array>
#include <cstddef>

namespace touchline {

/// Radial and tangential lens distortion of normalized image coordinates (Brown 1971; signs and order of the
/// coefficients as in OpenCV and most calibration tools).
///
/// The polynomial is not monotonic: beyond some radius, one pixel would belong to several directions. At the radius
/// where the radial slope falls to kMinSlope, the model therefore continues along the tangent. It is one-to-one and
/// finite in the whole plane, and equal to Brown's model wherever that model is meaningful.
class BrownDistortion {
 public:
  using Point = std::array<double, 2>;

  // An equidistant fish-eye lens reaches this slope at 72 degrees from its axis. No field is seen at such an angle.
  static constexpr double kMinSlope = 0.1;
  // This radius is 84 degrees from the axis, where a pinhole model is meaningless for any lens.
  static constexpr double kMaxRadius = 10.0;

  BrownDistortion() = default;
  BrownDistortion(double k1, double k2, double k3, double p1, double p2);

  /// Maps ideal coordinates to distorted ones.
  [[nodiscard]] Point distort(Point ideal) const;
  /// Maps distorted coordinates to ideal ones, with an error below 1e-10 within the limit.
  [[nodiscard]] Point undistort(Point distorted) const;
  /// Returns the ideal radius beyond which the tangent replaces the polynomial.
  [[nodiscard]] double limit() const { return limit_; }
  /// Returns the determinant of the Jacobian of distort(), the factor by which it scales a small area. 0 beyond the
  /// limit.
  [[nodiscard]] double stretch(Point ideal) const;

 private:
  // Jacobian of distort() within the limit. It is symmetric.
  struct Jacobian {
    double xx, xy, yy;
  };
  // Number of intervals in the table of initial guesses, equally spaced in the squared distorted radius.
  static constexpr std::size_t kGuesses = 32;

  // `square`: squared ideal radius. Both functions are inlined, because they share most of their terms.
  [[nodiscard, gnu::always_inline]] inline Point inside(Point ideal, double square) const;
  [[nodiscard, gnu::always_inline]] inline Point tangential_inside(Point ideal, double square) const;
  [[nodiscard, gnu::always_inline]] inline Jacobian jacobian(Point ideal, double square) const;
  bool undistort_by_newton(Point distorted, Point& ideal) const;
  [[nodiscard]] double radial(double r) const;
  [[nodiscard]] double radial_slope(double r) const;
  [[nodiscard]] double ideal_radius(double distorted, double guess) const;
  [[nodiscard]] Point tangential(Point ideal) const;

  double k1_ = 0, k2_ = 0, k3_ = 0, p1_ = 0, p2_ = 0;
  double limit_ = kMaxRadius;
  double radius_at_limit_ = kMaxRadius, slope_at_limit_ = 1.0;
  double guesses_per_square_ = 0;
  std::array<double, kGuesses + 1> guess_{};  // ratio of ideal to distorted radius; zero before construction
};

}  // namespace touchline
