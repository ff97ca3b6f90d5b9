#pragma once

#include <cmath>
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

/// Returns the least-squares pose (rotation and translation, no reflection, no scale) of at least two different points.
/// For the paper's two patches this is eq. (3): the middle of both, and the direction from one to the other.
RigidFit fit_rigidly(std::span<const Correspondence> points);

/// As fit_rigidly(), but returns false if the residual exceeds `most_m`, in most cases without computing the pose.
bool fit_rigidly_within(float most_m, std::span<const Correspondence> points, RigidFit& fit);

/// Covariance of a point's errors.
struct PointCovariance {
  float xx = 0, xy = 0, yy = 0;
};

/// Turns the covariance of a pose's errors from the frame of a robot with this heading to the field.
PoseCovariance to_field(const PoseCovariance& own, float theta_rad);

/// Returns the covariance of the pose that fit_rigidly() finds, for independent small errors of the seen points.
/// `places` and `errors` are in the robot's frame; `theta_rad` is the robot's heading. There must be at least two
/// different places.
PoseCovariance rigid_fit_noise(std::span<const FieldPoint> places, std::span<const PointCovariance> errors,
                               float theta_rad);

/// Transforms points of the field to a robot's frame.
class RobotFrame {
 public:
  explicit RobotFrame(const Pose& pose);
  FieldPoint operator()(FieldPoint point) const {
    const float x = point.x_m - origin_.x_m, y = point.y_m - origin_.y_m;
    return {c_ * x + s_ * y, c_ * y - s_ * x};
  }

 private:
  FieldPoint origin_;
  float c_, s_;
};
inline FieldPoint to_robot_frame(const Pose& pose, FieldPoint point) { return RobotFrame(pose)(point); }

inline float distance_m(FieldPoint a, FieldPoint b) {
  const float x = a.x_m - b.x_m, y = a.y_m - b.y_m;
  return std::sqrt(x * x + y * y);
}

}  // namespace touchline
