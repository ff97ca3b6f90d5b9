#pragma once

#include "tests/marker/painted_field.h"

// Marker layouts of real teams (../shared/footage has pictures of them), with complete teams.
namespace touchline::testing {

/// Team bar over the front half, two identification squares behind it.
MarkerLayout bar_layout();
/// Team half to the left, identification half to the right.
MarkerLayout halves_layout();
/// Team bar, one identification square in the middle of the other half.
MarkerLayout single_layout();
/// A square divided along its diagonal. The team's triangle is one half; the other half is divided again.
MarkerLayout triangles_layout();
/// Five disks: the team's in the center, four around it.
MarkerLayout disks_layout();

/// Both teams in this layout, blue and yellow, `robots` each. Identification colors are red, green and magenta, in
/// ordered sets that no two robots of a team share, and that both teams use.
MarkerParameters teams_with(const MarkerLayout& layout, std::size_t robots);

}  // namespace touchline::testing
