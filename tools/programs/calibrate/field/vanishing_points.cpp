#include "tools/programs/calibrate/field/vanishing_points.h"

#include <Eigen/Dense>
#include <cmath>

namespace touchline::calibrate {
namespace {

Eigen::Vector3d line_of(const HoughLine& line, const Eigen::Vector2d& center) {
  const Eigen::Vector2d normal(std::cos(line.angle_rad), std::sin(line.angle_rad));
  return {normal.x(), normal.y(), normal.dot(center) - line.distance_px};
}

// Returns the intersection, scaled so that a direction is a unit vector and w is the inverse of the distance.
VanishingPoint meeting(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  Eigen::Vector3d point = a.cross(b);
  point /= point.head<2>().norm();
  return {point.x(), point.y(), point.z()};
}

}  // namespace

std::optional<VanishingPointModel> vanishing_point_model(const BorderSearch& border, bool quarter_turned, int width_px,
                                                         int height_px, const FieldParameters& field) {
  const Eigen::Vector2d center(0.5 * (width_px - 1), 0.5 * (height_px - 1));
  // Order in the picture: bottom, right, top, left.
  const std::array<Eigen::Vector3d, 4> sides{
      line_of(border.straight_sides[0], center), line_of(border.straight_sides[1], center),
      line_of(border.straight_sides[2], center), line_of(border.straight_sides[3], center)};
  VanishingPointModel steps;
  steps.h_px = border.h_px;
  const VanishingPoint across = meeting(sides[0], sides[2]), up = meeting(sides[1], sides[3]);
  steps.along_x = quarter_turned ? up : across;
  steps.along_y = quarter_turned ? across : up;
  // The x axis points to the right, or upwards.
  const double sign = quarter_turned ? (steps.along_x.y < 0 ? 1.0 : -1.0) : (steps.along_x.x > 0 ? 1.0 : -1.0);
  steps.rotation_rad = std::atan2(sign * steps.along_x.y, sign * steps.along_x.x);
  // Solve p x + q y = w at both points. For points on the axes this is 1 / d of eq. (15).
  Eigen::Matrix2d points;
  points << steps.along_x.x, steps.along_x.y, steps.along_y.x, steps.along_y.y;
  if (std::abs(points.determinant()) < 0.1) return std::nullopt;
  const Eigen::Vector2d tilt = points.inverse() * Eigen::Vector2d(steps.along_x.w, steps.along_y.w);
  steps.p_per_px = tilt.x();
  steps.q_per_px = tilt.y();

  const std::array<std::array<double, 2>, 4> signs{{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}};
  Eigen::Matrix<double, 4, 3> rectified;
  Eigen::Matrix<double, 4, 2> floor;
  for (std::size_t i = 0; i < 4; ++i) {
    const PixelPoint& corner = border.straight_corners[(i + (quarter_turned ? 1 : 0)) % 4];
    const Eigen::Vector2d at =
        Eigen::Vector2d(static_cast<double>(corner.u_px), static_cast<double>(corner.v_px)) - center;
    const double d = 1 - tilt.dot(at);
    const auto row = static_cast<Eigen::Index>(i);
    if (d <= 0) return std::nullopt;
    rectified.row(row) << at.x() / d, at.y() / d, 1;
    floor.row(row) << signs[i][0] * static_cast<double>(field.length_m) / 2,
        signs[i][1] * static_cast<double>(field.width_m) / 2;
  }
  const Eigen::ColPivHouseholderQR<Eigen::Matrix<double, 4, 3>> solver(rectified);
  if (solver.rank() < 3) return std::nullopt;
  const Eigen::Matrix<double, 3, 2> affine = solver.solve(floor);
  steps.model.center_u_px = static_cast<float>(center.x());
  steps.model.center_v_px = static_cast<float>(center.y());
  steps.model.focal_px = static_cast<float>(border.h_px);
  steps.model.p_per_px = static_cast<float>(tilt.x());
  steps.model.q_per_px = static_cast<float>(tilt.y());
  for (Eigen::Index axis = 0; axis < 2; ++axis) {
    for (Eigen::Index i = 0; i < 3; ++i) {
      steps.model.affine[static_cast<std::size_t>(3 * axis + i)] = static_cast<float>(affine(i, axis));
    }
  }
  // Any height above the floor works, because the mapping of the floor does not depend on it.
  steps.model.position_m = {0, 0, 1};
  return steps;
}

}  // namespace touchline::calibrate
