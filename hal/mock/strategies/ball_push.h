#pragma once

#include "core/geometry/field_area.h"
#include "core/geometry/vector2.h"
#include "core/types.h"
#include "hal/mock/strategies/drive_law.h"

namespace touchline::hal::mock {

/// Drives around the ball to the side from which a push moves it to the middle of the opponent's goal, and pushes it;
/// drives straight at the ball if there is no room behind it. `radius_m`: half the side of a robot.
Twist push_ball(const Pose& robot, Vector2 ball, const FieldParameters& field, double radius_m, const DriveLaw& law);

}  // namespace touchline::hal::mock
