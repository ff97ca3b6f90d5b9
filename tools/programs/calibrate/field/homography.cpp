#include "tools/programs/calibrate/field/homography.h"

#include <cmath>

namespace touchline::calibrate {
namespace {

// Normalization: moves the mean of the points to the origin and scales their mean distance to sqrt(2) (Hartley 1997).
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
  Eigen::MatrixXd equations(static_cast<Eigen::Index>(2 * points.size()), 9);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d a = floor_scale * floor[i].homogeneous();
    const Eigen::Vector3d b = picture_scale * picture[i].homogeneous();
    const auto row = static_cast<Eigen::Index>(2 * i);
    equations.row(row) << a.transpose(), 0, 0, 0, -b.x() * a.transpose();
    equations.row(row + 1) << 0, 0, 0, a.transpose(), -b.y() * a.transpose();
  }
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(equations, Eigen::ComputeFullV);
  // The solution is not unique: three of four points on a line, or coincident points.
  constexpr double kSingular = 1e-4;
  if (svd.singularValues()(7) < kSingular * svd.singularValues()(0)) return std::nullopt;
  const Eigen::VectorXd h = svd.matrixV().col(8);
  Eigen::Matrix3d normalized;
  normalized << h(0), h(1), h(2), h(3), h(4), h(5), h(6), h(7), h(8);
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
  // The nearest rotation matrix.
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(rotation, Eigen::ComputeFullU | Eigen::ComputeFullV);
  rotation = svd.matrixU() * svd.matrixV().transpose();
  const Eigen::AngleAxisd turn(rotation);
  return {turn.angle() * turn.axis(), -rotation.transpose() * columns.col(2)};
}

}  // namespace touchline::calibrate
