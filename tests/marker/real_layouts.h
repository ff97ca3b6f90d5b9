#pragma once

#include "tests/marker/painted_field.h"

// Marker layouts of real teams (../shared/footage has pictures of them), with complete teams.
namespace touchline::testing {

/// Layout with a team bar over the front half, and two identification squares behind it.
MarkerLayout bar_layout();
/// Layout with the team half to the left, and the identification half to the right.
MarkerLayout halves_layout();
/// Layout with a team bar, and one identification square in the middle of the other half.
MarkerLayout single_layout();
/// Layout of a square divided along its diagonal. The team's triangle is one half; the other half is divided again.
MarkerLayout triangles_layout();
/// Layout of five disks: the team's in the center, four around it.
MarkerLayout disks_layout();

/// Returns both teams in this layout, blue and yellow, with `robots` each. Identification colors are red, green and
/// magenta, in ordered sets that no two robots of a team share, and that both teams use.
MarkerParameters teams_with(const MarkerLayout& layout, std::size_t robots);

}  // namespace touchline::testing
