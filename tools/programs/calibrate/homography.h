#pragma once

#include <Eigen/Dense>
#include <optional>
#include <vector>

#include "tools/programs/calibrate/field_fit.h"

namespace touchline::calibrate {

/// Floor (x, y, 1) -> picture (u, v, 1) about the given center, scaled so that points in front of the camera have a
/// positive third coordinate. None when the points do not determine it.
std::optional<Eigen::Matrix3d> floor_to_picture(const std::vector<FloorPoint>& points, double center_u_px,
                                                double center_v_px);

/// 1 / f^2 from the two conditions that the columns of a rotation put on a homography about the principal point (their
/// vanishing points are perpendicular, their lengths equal), in the least-squares sense. Not positive when the picture
/// does not tell: a vertical camera.
double inverse_focal_squared(const Eigen::Matrix3d& homography);

struct CameraPose {
  Eigen::Vector3d rotation;  // vector, field frame -> camera frame
  Eigen::Vector3d position;  // of the camera in the field frame
};
/// The pose that a homography about the principal point means at this focal length (px).
CameraPose pose_from(const Eigen::Matrix3d& homography, double focal_px);

}  // namespace touchline::calibrate
