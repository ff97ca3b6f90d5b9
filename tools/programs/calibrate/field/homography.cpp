#include "tools/programs/calibrate/field/homography.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace touchline::calibrate {
namespace {

// Returns the normalization that moves the mean of the points to the origin and scales their mean distance to sqrt(2)
// (Hartley 1997).
Eigen::Matrix3d normalization(const std::vector<Eigen::Vector2d>& points) {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const auto& p : points) mean += p;
  mean /= static_cast<double>(points.size());
  double distance = 0;
  for (const auto& p : points) distance += (p - mean).norm();
  distance /= static_cast<double>(points.size());
  const double scale = distance > 0 ? std::sqrt(2.0) / distance : 1.0;
  Eigen::Matrix3d transform = Eigen::Matrix3d::Identity();
  transform(0, 0) = transform(1, 1) = scale;
  transform.block<2, 1>(0, 2) = -scale * mean;
  return transform;
}

using Equation = std::array<double, 9>;

// Returns the unit vector with the smallest residual in all equations: the right singular vector of the smallest
// singular value, by one-sided Jacobi rotations (Hestenes 1958). Eigen's decompositions are equally exact, but take ten
// seconds to compile. Empty if the second smallest singular value is almost zero: three of four points lie on a line,
// or points coincide.
std::optional<Equation> null_vector(std::vector<Equation> equations) {
  std::array<Equation, 9> vectors{};  // accumulated rotations; element k is a row
  for (std::size_t k = 0; k < 9; ++k) vectors[k][k] = 1.0;
  const auto rotate = [](auto& rows, std::size_t p, std::size_t q, double c, double s) {
    for (Equation& row : rows) {
      const double left = row[p];
      row[p] = c * left - s * row[q];
      row[q] = s * left + c * row[q];
    }
  };
  bool is_orthogonal = false;
  for (int sweep = 0; sweep < 30 && !is_orthogonal; ++sweep) {
    is_orthogonal = true;
    for (std::size_t p = 0; p < 8; ++p) {
      for (std::size_t q = p + 1; q < 9; ++q) {
        double pp = 0, qq = 0, pq = 0;
        for (const Equation& row : equations) {
          pp += row[p] * row[p];
          qq += row[q] * row[q];
          pq += row[p] * row[q];
        }
        if (std::abs(pq) <= 1e-15 * std::sqrt(pp * qq)) continue;
        is_orthogonal = false;
        const double half = (qq - pp) / (2 * pq);
        const double t = std::copysign(1.0, half) / (std::abs(half) + std::hypot(1.0, half));
        const double c = 1 / std::hypot(1.0, t);
        rotate(equations, p, q, c, c * t);
        rotate(vectors, p, q, c, c * t);
      }
    }
  }
  std::array<std::pair<double, std::size_t>, 9> values{};  // (singular value, its column)
  for (std::size_t k = 0; k < 9; ++k) {
    double square = 0;
    for (const Equation& row : equations) square += row[k] * row[k];
    values[k] = {std::sqrt(square), k};
  }
  std::sort(values.begin(), values.end());
  constexpr double kSingular = 1e-4;
  if (values[1].first < kSingular * values[8].first) return std::nullopt;
  Equation out;
  for (std::size_t k = 0; k < 9; ++k) out[k] = vectors[k][values[0].second];
  return out;
}

}  // namespace

std::optional<Eigen::Matrix3d> floor_to_picture(const std::vector<FloorPoint>& points, double center_u_px,
                                                double center_v_px) {
  if (points.size() < 4) return std::nullopt;
  std::vector<Eigen::Vector2d> floor, picture;
  for (const FloorPoint& p : points) {
    floor.emplace_back(p.x_m, p.y_m);
    picture.emplace_back(p.u_px - center_u_px, p.v_px - center_v_px);
  }
  const Eigen::Matrix3d floor_scale = normalization(floor), picture_scale = normalization(picture);
  std::vector<Equation> equations;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d a = floor_scale * floor[i].homogeneous();
    const Eigen::Vector3d b = picture_scale * picture[i].homogeneous();
    equations.push_back({a.x(), a.y(), a.z(), 0, 0, 0, -b.x() * a.x(), -b.x() * a.y(), -b.x() * a.z()});
    equations.push_back({0, 0, 0, a.x(), a.y(), a.z(), -b.y() * a.x(), -b.y() * a.y(), -b.y() * a.z()});
  }
  const std::optional<Equation> solution = null_vector(equations);
  if (!solution) return std::nullopt;
  const Equation& h = *solution;
  Eigen::Matrix3d normalized;
  normalized << h[0], h[1], h[2], h[3], h[4], h[5], h[6], h[7], h[8];
  Eigen::Matrix3d homography = picture_scale.inverse() * normalized * floor_scale;
  homography /= homography.norm();
  if ((homography * floor[0].homogeneous()).z() < 0) homography = -homography;
  for (const auto& p : floor) {
    if ((homography * p.homogeneous()).z() <= 0) return std::nullopt;
  }
  return homography;
}

double inverse_focal_squared(const Eigen::Matrix3d& h) {
  const double a1 = h(0, 0) * h(0, 1) + h(1, 0) * h(1, 1), b1 = h(2, 0) * h(2, 1);
  const double a2 = h(0, 0) * h(0, 0) + h(1, 0) * h(1, 0) - h(0, 1) * h(0, 1) - h(1, 1) * h(1, 1);
  const double b2 = h(2, 0) * h(2, 0) - h(2, 1) * h(2, 1);
  const double square = a1 * a1 + a2 * a2;
  return square > 0 ? -(a1 * b1 + a2 * b2) / square : 0.0;
}

CameraPose pose_from(const Eigen::Matrix3d& homography, double focal_px) {
  Eigen::Matrix3d columns = homography;
  columns.topRows<2>() /= focal_px;
  const double scale = 2.0 / (columns.col(0).norm() + columns.col(1).norm());
  columns *= scale;
  Eigen::Matrix3d rotation;
  rotation << columns.col(0), columns.col(1), columns.col(0).cross(columns.col(1));
  // Compute the nearest rotation matrix by Newton's iteration for the polar decomposition (Higham 1986). Each step
  // doubles the number of correct digits. Unlike an SVD, it compiles quickly.
  for (int i = 0; i < 10; ++i) rotation = (0.5 * (rotation + rotation.inverse().transpose())).eval();
  const Eigen::AngleAxisd turn(rotation);
  return {turn.angle() * turn.axis(), -rotation.transpose() * columns.col(2)};
}

}  // namespace touchline::calibrate
