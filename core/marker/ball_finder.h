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

/// The ball as a circular patch at the height of its center.
PatchPlace outline_of(const BallParameters& ball);

/// Finds the ball: the candidate whose area fits best and whose region looks like a disk. Candidates on the top of a
/// reported robot have a much lower rank. If two candidates are about equally likely, no ball is reported. `patches`:
/// candidates of the ball's color inside the field. `out.robots` must be complete.
void find_ball(const ColorPatches& patches, const PatchFinder& finder, const std::array<TeamMarking, 2>& teams,
               const Regions& regions, Sightings& out);

}  // namespace touchline
