#pragma once

#include <numbers>

#include "core/geometry/angle.h"
#include "hal/mock/world.h"

namespace touchline::hal::mock {

/// Returns a place on the field turned by 180 degrees, as the other side sees it.
inline Placement turned(const Placement& at) { return {-at.x_m, -at.y_m, wrap_angle(at.theta_rad + std::numbers::pi)}; }

}  // namespace touchline::hal::mock
