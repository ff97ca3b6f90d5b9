#pragma once

#include "core/geometry/field_area.h"
#include "core/geometry/vector2.h"
#include "core/types.h"

namespace touchline {

// All robots but the own one, and the ball.
using Obstacles = FixedVector<Vector2, kMaxRobots>;

/// Where to go next on the way to `target`: the target itself when the straight way is free, else a place beside the
/// nearest obstacle that blocks it, on the side that is shorter and inside the field. An obstacle at the target itself
/// blocks nothing: whoever goes there means to. `clearance_m`: free distance from an obstacle's center to the way.
Vector2 detour(Vector2 from, Vector2 target, const Obstacles& obstacles, double clearance_m,
               const FieldParameters& field);

}  // namespace touchline
