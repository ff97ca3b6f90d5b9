#pragma once

#include "core/types.h"

// The field turned by 180 degrees about its center, for a team that defends the half with positive x.
namespace touchline {

Pose turned(const Pose& pose);

/// Turns all positions, headings and velocities.
void turn(const Tracks& tracks, Tracks& out);

}  // namespace touchline
