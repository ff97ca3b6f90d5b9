#pragma once

#include <span>

#include "core/types.h"

namespace touchline {

/// A point in the robot's frame and the corresponding point on the field.
struct Correspondence {
  FieldPoint place, seen;
};

struct RigidFit {
  Pose pose;             // transforms points of the robot to the field
  float residual_m = 0;  // RMS distance after the transformation
};

/// Least-squares pose (rotation and translation, no reflection, no scale) of at least two different points. For the
/// paper's two patches this is eq. (3): the middle of both, and the direction from one to the other.
RigidFit fit_rigidly(std::span<const Correspondence> points);

/// Covariance of a point's errors.
struct PointCovariance {
  float xx = 0, xy = 0, yy = 0;
};

/// Covariance of the pose that fit_rigidly() finds, for independent small errors of the seen points. `places` and
/// `errors` are in the robot's frame; `theta_rad` is the robot's heading. Needs at least two different places.
PoseCovariance rigid_fit_noise(std::span<const FieldPoint> places, std::span<const PointCovariance> errors,
                               float theta_rad);

/// Transforms a point of the field to the robot's frame.
FieldPoint to_robot_frame(const Pose& pose, FieldPoint point);

float distance_m(FieldPoint a, FieldPoint b);

}  // namespace touchline
