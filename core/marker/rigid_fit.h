#pragma once

#include <span>

#include "core/types.h"

namespace touchline {

/// A place in the robot's frame and where on the field it was seen.
struct Correspondence {
  FieldPoint place, seen;
};

struct RigidFit {
  Pose pose;             // takes places to what was seen
  float residual_m = 0;  // RMS distance between both
};

/// The pose (rotation and translation, no reflection, no scale) of least squared distances. At least two different
/// places. For the paper's two patches this is eq. (3): the middle of both, and the direction from one to the other.
RigidFit fit_rigidly(std::span<const Correspondence> points);

/// Where the robot's frame has a point of the field.
FieldPoint to_robot_frame(const Pose& pose, FieldPoint point);

float distance_m(FieldPoint a, FieldPoint b);

}  // namespace touchline
