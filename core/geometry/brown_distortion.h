#pragma once

#include <array>
#include <cstddef>

namespace touchline {

/// Radial and tangential lens distortion of normalized image coordinates (Brown 1971; signs and order of the
/// coefficients as in OpenCV and most calibration tools).
///
/// The polynomial folds back at some radius, beyond which one pixel would belong to several directions. There the
/// model ends: from the radius at which its radial slope has fallen to kLeastSlope on, it goes on along the tangent.
/// So it is one-to-one over the whole plane, equal to Brown's wherever that one makes sense, and finite everywhere.
class BrownDistortion {
 public:
  using Point = std::array<double, 2>;

  // An equidistant fish-eye lens has this slope 72 degrees off its axis: no field is seen so obliquely.
  static constexpr double kLeastSlope = 0.1;
  // 84 degrees off the axis, where a pinhole model of any lens has lost its meaning.
  static constexpr double kLargestRadius = 10.0;

  BrownDistortion() = default;
  BrownDistortion(double k1, double k2, double k3, double p1, double p2);

  /// Ideal -> distorted.
  [[nodiscard]] Point distort(Point ideal) const;
  /// Distorted -> ideal, to 1e-10 within the limit.
  [[nodiscard]] Point undistort(Point distorted) const;
  /// Ideal radius from which on the tangent replaces the polynomial.
  [[nodiscard]] double limit() const { return limit_; }
  /// Determinant of distort()'s derivatives: the area that a small area becomes. 0: beyond the limit it is not known.
  [[nodiscard]] double stretch(Point ideal) const;

 private:
  // Derivatives of distort() within the limit, x by y being y by x.
  struct Slope {
    double xx, xy, yy;
  };
  // Intervals of the table of first guesses, evenly over the squared distorted radius.
  static constexpr std::size_t kGuesses = 32;

  // `square`: of the ideal radius.
  [[nodiscard]] Point inside(Point ideal, double square) const;
  [[nodiscard]] Point tangential_inside(Point ideal, double square) const;
  [[nodiscard]] Slope slope(Point ideal, double square) const;
  bool undistort_quickly(Point distorted, Point& ideal) const;
  [[nodiscard]] double radial(double r) const;
  [[nodiscard]] double radial_slope(double r) const;
  [[nodiscard]] double ideal_radius(double distorted, double guess) const;
  [[nodiscard]] Point tangential(Point ideal) const;

  double k1_ = 0, k2_ = 0, k3_ = 0, p1_ = 0, p2_ = 0;
  double limit_ = kLargestRadius;
  double radius_at_limit_ = kLargestRadius, slope_at_limit_ = 1.0;
  double guesses_per_square_ = 0;
  std::array<double, kGuesses + 1> guess_{};  // of ideal by distorted radius; zero: none was made
};

}  // namespace touchline
