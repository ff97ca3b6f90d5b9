#pragma once

#include <array>
#include <span>

#include "core/marker/marker_layout.h"
#include "core/marker/patch_finder.h"
#include "core/types.h"

namespace touchline {

struct BallParameters {
  ColorId color = kBackground;
  float radius_m = 0.02135f;
};

/// The disk that a ball shows, as a patch at the height of its center.
PatchPlace outline_of(const BallParameters& ball);

/// The one region of the ball's color that is a ball by its size and shape, inside the field, and not on a reported
/// robot's top unless nothing else is there. Two that are equally likely: none. `patches`: of the ball's color, not
/// among them what is too small or too large. `out.robots` must be complete.
void find_ball(const ColorPatches& patches, const PatchFinder& finder, const std::array<TeamMarking, 2>& teams,
               const Regions& regions, Sightings& out);

}  // namespace touchline
