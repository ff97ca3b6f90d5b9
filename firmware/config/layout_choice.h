#pragma once

#include <optional>

#include "core/marker/marker_layout.h"
#include "firmware/config/team_file.h"

namespace touchline::config {

/// Returns the layout that a [[layout]] declares. Patches beyond kMaxPatches are dropped; the caller reports them.
MarkerLayout layout_of(const LayoutEntry& entry);

/// Returns the layout that a team names: a [[layout]] of the file, or a standard layout. If the team gives a height,
/// the layout gets this height. Empty if there is no layout of this name.
std::optional<MarkerLayout> chosen_layout(const TeamFile& file, const TeamEntry& team);

/// Returns the angle from the robot's axes to the sides of its square body, 0 to pi/2. It is 0 if the body then
/// contains all patches, otherwise the angle at which the smallest square contains them (mirosot-triangles: forward is
/// a corner of the body).
float body_turn_rad(const MarkerLayout& layout);

}  // namespace touchline::config
