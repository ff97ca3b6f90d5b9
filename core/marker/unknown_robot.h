#pragma once

#include "core/geometry/camera_model.h"
#include "core/marker/marker_layout.h"
#include "core/types.h"

namespace touchline {

/// Least confidence with which a robot without an id is reported. Below it, the odds are ten to one against a robot.
constexpr float kMinUnknownIdProbability = 0.1f;
/// Largest confidence in a robot without an id: things exist that look like one.
constexpr float kMaxUnknownIdProbability = 0.99f;

struct LikelyRobot {
  float probability = 0;
  float heading_rad = 0;  // the robot's, or the direction in which the picture resembles the layout best
};

/// Returns the probability that a robot without an id is a robot of this team, and its likely direction. Any object may
/// have the team's color. A robot has the outline of its team patch. In one direction beside it are patches that differ
/// from the floor, the team color and the top, whatever colors they have. `area_ratio`: visible area of the team patch
/// relative to the layout's. `has_stripes`: another region of the team's color without an id is within a robot's side.
LikelyRobot likely_robot(const Frame& frame, const CameraModel& camera, const MarkerLayout& layout,
                         const RobotSighting& robot, float area_ratio, bool has_stripes);

/// Removes robots without an id whose confidence is below kMinUnknownIdProbability.
void drop_unlikely_robots(FixedVector<RobotSighting, kMaxRobots>& robots);

/// Returns false if the outline of the team patch differs from the layout, for example because the region is a part of
/// a larger surface. The robot must have a heading.
bool has_team_outline(const Frame& frame, const CameraModel& camera, const MarkerLayout& layout,
                      const RobotSighting& robot);

/// Returns true if the pixels show all patches of the layout in the robot's pose: each patch differs from its
/// surroundings and has the outline of the layout. The robot must have a heading.
bool has_all_outlines(const Frame& frame, const CameraModel& camera, const MarkerLayout& layout,
                      const RobotSighting& robot);

}  // namespace touchline
