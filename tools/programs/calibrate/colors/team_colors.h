#pragma once

#include <string>
#include <vector>

#include "core/marker/matcher.h"
#include "hal/result.h"

namespace touchline::calibrate {

/// The colors in a team file and their use.
struct TeamColors {
  std::vector<std::string> names;  // ColorId is the index + 1; team colors, ball, then identification colors
  MarkerParameters marker;         // markers with these ColorIds
};

/// Reads and checks a team file without a venue. Errors of config::read_toml() and resolve_team().
Result<TeamColors> read_team_colors(const std::string& path);

}  // namespace touchline::calibrate
