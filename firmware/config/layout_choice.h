#pragma once

#include <optional>

#include "core/marker/marker_layout.h"
#include "firmware/config/team_file.h"

namespace touchline::config {

/// The layout that a [[layout]] declares. Patches beyond kMaxPatches are left out; the caller reports them.
MarkerLayout layout_of(const LayoutEntry& entry);

/// The layout that a team names: a [[layout]] of the file, or a standard layout; with the height of the team if it
/// gives one. Empty if there is no layout of this name.
std::optional<MarkerLayout> chosen_layout(const TeamFile& file, const TeamEntry& team);

}  // namespace touchline::config
