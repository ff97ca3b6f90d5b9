#pragma once

#include <array>

#include "core/fixed_vector.h"
#include "core/geometry/camera_model.h"
#include "core/marker/marker_layout.h"
#include "core/types.h"

namespace touchline {

/// The square top of a robot near a possible ball, in pixels. It hides a ball that lies under it.
struct RobotTop {
  PixelPoint center;
  std::array<PixelPoint, 2> half_side;  // vectors from the center to the middle of two adjacent sides
  PixelPoint foot;                      // center of the robot's square on the floor
  float height_m = 0;
};

/// Size of a team's robots; a side of 0 means that they are unknown and hide nothing.
struct RobotSize {
  float side_m = 0, height_m = 0;
};

std::array<RobotSize, 2> sizes_of(const std::array<TeamMarking, 2>& teams);

/// Returns the tops of the robots that may hide a ball at `ball`, if their heading was seen. `sizes`: by Team.
FixedVector<RobotTop, kMaxRobots> tops_near(FieldPoint ball, const CameraModel& camera,
                                            const std::array<RobotSize, 2>& sizes, const Sightings& seen);

}  // namespace touchline
