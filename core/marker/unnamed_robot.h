#pragma once

#include "core/geometry/camera_model.h"
#include "core/marker/marker_layout.h"
#include "core/types.h"

namespace touchline {

/// Unnamed robots below this confidence are not reported: ten to one, the thing is no robot.
constexpr float kLeastUnnamed = 0.1f;

/// Probability that a robot of this team is where one without an id was seen. A region of the team's color may be any
/// thing; a robot has the outline of its team patch, and beside it, in one direction, patches that differ from the
/// floor, from the team color and from the top around the team patch, whichever colors they have. `area_ratio`: visible
/// area of the team patch relative to the layout's. `has_stripes`: another region of the team's color without an id is
/// within a robot's side.
float confidence_without_id(const Frame& frame, const CameraModel& camera, const MarkerLayout& layout,
                            const RobotSighting& robot, float area_ratio, bool has_stripes);

/// False if the surface at the team patch of a robot with a heading has not its outline, for example because it is a
/// part of a larger surface.
bool has_team_outline(const Frame& frame, const CameraModel& camera, const MarkerLayout& layout,
                      const RobotSighting& robot);

/// True if pixels show a robot with a heading as the layout has it: its team patch and all identification patches
/// differ from what is around them, and end where the layout's do.
bool has_all_outlines(const Frame& frame, const CameraModel& camera, const MarkerLayout& layout,
                      const RobotSighting& robot);

}  // namespace touchline
