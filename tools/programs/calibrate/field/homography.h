#pragma once

#include <Eigen/Dense>
#include <optional>
#include <vector>

#include "tools/programs/calibrate/field/field_fit.h"

namespace touchline::calibrate {

/// Returns the homography from the floor (x, y, 1) to the picture (u, v, 1) relative to the given center, scaled so
/// that points in front of the camera have a positive third coordinate. Returns nullopt if the points do not determine
/// a homography.
std::optional<Eigen::Matrix3d> floor_to_picture(const std::vector<FloorPoint>& points, double center_u_px,
                                                double center_v_px);

/// Returns 1 / f^2 by least squares. The columns of a rotation matrix give two conditions on a homography relative to
/// the principal point: their vanishing points are perpendicular, and their lengths equal. The result is not positive
/// if the picture does not determine it (a vertical camera).
double inverse_focal_squared(const Eigen::Matrix3d& homography);

struct CameraPose {
  Eigen::Vector3d rotation;  // rotation vector, field frame to camera frame
  Eigen::Vector3d position;  // camera in the field frame
};
/// Decomposes a homography relative to the principal point into the camera pose at this focal length (px).
CameraPose pose_from(const Eigen::Matrix3d& homography, double focal_px);

}  // namespace touchline::calibrate
