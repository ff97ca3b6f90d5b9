#include "tools/programs/calibrate/field/hough_sides.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace touchline::calibrate {
namespace {

constexpr int kAngles = 360;  // half a degree apart
// Tolerance of the line fit in a picture of width kUsualWidth_px; it is needed because lens distortion bends the sides.
// It grows in proportion to the width.
constexpr int kUsualBend_px = 3, kUsualWidth_px = 640;
// Tolerance of right angles: perspective turns the rectangle into a general quadrilateral.
constexpr double kSkew_rad = 0.45;
// Least distance of a side from the center, in standard deviations of the outline. The sides of a rectangle are at 1 to
// 1.7; the markings inside are nearer.
constexpr double kMinDeviations = 0.8;

double angle_of(int a) { return std::numbers::pi * a / kAngles; }

/// Votes of the outline's pixels by angle. They are counted when an angle is first needed, because about half of the
/// angles never are. Distances are at most the picture's diagonal.
class Votes {
 public:
  Votes(const std::vector<OutlinePixel>& outline, int width_px, int height_px)
      : outline_(outline),
        bend_px_(std::max(kUsualBend_px, kUsualBend_px * width_px / kUsualWidth_px)),
        diagonal_px_(static_cast<int>(std::ceil(std::hypot(width_px, height_px)))) {}

  /// Returns the votes within the tolerance of each distance, beginning with the distance first_px().
  const std::vector<std::uint32_t>& at(int angle) {
    std::vector<std::uint32_t>& sums = sums_[static_cast<std::size_t>(angle)];
    if (sums.empty()) sums = count(angle_of(angle));
    return sums;
  }
  [[nodiscard]] int first_px() const { return bend_px_ - diagonal_px_; }

 private:
  [[nodiscard]] std::vector<std::uint32_t> count(double angle_rad) const {
    std::vector<std::uint32_t> votes(2 * static_cast<std::size_t>(diagonal_px_) + 1);
    // Uses pointers, because builds with sanitizers call a function for each element of a vector.
    std::uint32_t* const to = votes.data();
    const double c = std::cos(angle_rad), s = std::sin(angle_rad), to_index = diagonal_px_ + 0.5;  // adding 0.5 rounds
    for (const OutlinePixel& p : outline_) ++to[static_cast<std::size_t>(p.u_px * c + p.v_px * s + to_index)];

    const std::size_t width = 2 * static_cast<std::size_t>(bend_px_) + 1;
    std::vector<std::uint32_t> sums(votes.size() - width + 1);
    std::uint32_t sum = 0;
    for (std::size_t d = 0; d < votes.size(); ++d) {
      sum += votes[d];
      if (d + 1 < width) continue;
      sums[d + 1 - width] = sum;
      sum -= votes[d + 1 - width];
    }
    return sums;
  }

  const std::vector<OutlinePixel>& outline_;
  int bend_px_, diagonal_px_;
  std::array<std::vector<std::uint32_t>, kAngles> sums_;
};

}  // namespace

bool hough_sides(const std::vector<OutlinePixel>& outline, int width_px, int height_px,
                 std::array<HoughLine, 4>& sides) {
  Votes votes(outline, width_px, height_px);
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  for (const OutlinePixel& p : outline) middle += Eigen::Vector2d(p.u_px, p.v_px) / static_cast<double>(outline.size());
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  for (const OutlinePixel& p : outline) {
    const Eigen::Vector2d away = Eigen::Vector2d(p.u_px, p.v_px) - middle;
    spread += away * away.transpose() / static_cast<double>(outline.size());
  }
  // Finds the best line whose normal is within kSkew_rad of `direction`. The line must lie on this side of the center
  // and far enough from it, because a center line is as long as a side.
  const auto best = [&](double direction) {
    constexpr double kPi = std::numbers::pi;
    HoughLine line;
    for (int a = 0; a < kAngles; ++a) {
      const double angle = angle_of(a);
      double turn = std::remainder(angle - direction, 2 * kPi);
      double sign = 1;
      if (std::abs(turn) > kPi / 2) {
        sign = -1;
        turn = std::remainder(angle + kPi - direction, 2 * kPi);
      }
      if (std::abs(turn) > kSkew_rad) continue;
      const Eigen::Vector2d normal(std::cos(angle), std::sin(angle));
      const double at_middle = middle.dot(normal), deviation = std::sqrt(normal.dot(spread * normal));
      int distance = votes.first_px();
      for (const std::uint32_t near : votes.at(a)) {
        if (near > line.votes && sign * (distance - at_middle) >= kMinDeviations * deviation) {
          line = {angle, static_cast<double>(distance), near};
        }
        ++distance;
      }
    }
    return line;
  };
  HoughLine first;
  for (const double direction : {0.0, std::numbers::pi / 2, std::numbers::pi, -std::numbers::pi / 2}) {
    if (const HoughLine line = best(direction); line.votes > first.votes) first = line;
  }
  // Directions down, right, up and left in the picture, rotated like the field.
  const double quarter = std::numbers::pi / 2, turn = std::remainder(first.angle_rad, quarter);
  const std::array<double, 4> directions{quarter + turn, turn, -quarter + turn, 2 * quarter + turn};
  for (std::size_t i = 0; i < 4; ++i) {
    sides[i] = best(directions[i]);
    if (sides[i].votes < kMinVotes) return false;
  }
  return true;
}

}  // namespace touchline::calibrate
