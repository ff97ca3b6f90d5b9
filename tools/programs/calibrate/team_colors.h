#pragma once

#include <string>
#include <vector>

#include "core/marker/matcher.h"
#include "core/status.h"

namespace touchline::calibrate {

/// The colors that a team file names, and what they mean.
struct TeamColors {
  std::vector<std::string> names;  // ColorId is the index + 1; teams, ball, then identification
  MarkerParameters marker;         // its colors are these
};

/// Reads and checks a team file without a venue. Errors as of config::read_toml() and resolve_team(); `reason` has all
/// lines.
Status read_team_colors(const std::string& path, TeamColors& out, std::string& reason);

}  // namespace touchline::calibrate
