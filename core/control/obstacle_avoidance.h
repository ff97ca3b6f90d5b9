#pragma once

#include "core/geometry/field_area.h"
#include "core/geometry/vector2.h"
#include "core/types.h"

namespace touchline {

// Positions of all other robots.
using Obstacles = FixedVector<Vector2, kMaxRobots>;

/// Lists the positions of all robots of `tracks` except the own robot `id`.
void obstacles_for(RobotId id, const Tracks& tracks, Obstacles& out);

/// Returns the next waypoint on the way to `target`: the target itself if the straight way is free, else a point beside
/// the nearest blocking obstacle, on the shorter side and inside the field. An obstacle at the target does not block,
/// because the robot is meant to go there. `clearance_m`: required distance from an obstacle's center to the way.
Vector2 detour(Vector2 from, Vector2 target, const Obstacles& obstacles, double clearance_m,
               const FieldParameters& field);

}  // namespace touchline
