#pragma once

#include "core/geometry/vector2.h"
#include "core/pipeline.h"

namespace touchline::control_evaluation {

struct BoundPose {
  Vector2 place;
  double heading_rad = 0.0;
};

/// Returns the time in which a robot with the drive's limits gets from rest to rest at a pose, without delay, by the
/// fastest of two maneuvers, each forward and backward, of which parts may overlap:
/// - turn in place, drive straight, turn in place; a part begins when the robot has its place and heading;
/// - the same with turns for free while the robot accelerates and brakes. This is a lower bound of the turns on the
///   spot: a robot that drives while it turns leaves the straight line.
/// The result is the mean of the two: the optimum of a robot that may overlap lies between them.
double least_time_s(const BoundPose& from, const BoundPose& to, const PipelineParameters& parameters);

}  // namespace touchline::control_evaluation
