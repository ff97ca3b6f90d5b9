#include "tools/programs/calibrate/colors/team_colors.h"

#include <algorithm>
#include <memory>

#include "firmware/config/resolve.h"
#include "firmware/config/team_file.h"
#include "firmware/config/toml_file.h"

namespace touchline::calibrate {

Result<TeamColors> read_team_colors(const std::string& path) {
  TeamColors out;
  config::TeamFile team;
  config::Locations where;
  TOUCHLINE_TRY(config::read_toml(path, "", {}, team, where));
  std::vector<std::string> names = {team.own.color, team.opponent.color, team.ball.color};
  for (const auto* side : {&team.own, &team.opponent}) {
    for (const auto& robot : side->robot) names.insert(names.end(), robot.colors.begin(), robot.colors.end());
  }
  // A venue that has all colors is used, so that the remaining errors are those of the team file.
  config::VenueFile venue;
  for (const std::string& name : names) {
    if (name.empty() || std::find(out.names.begin(), out.names.end(), name) != out.names.end()) continue;
    out.names.push_back(name);
    venue.color.emplace_back();
    venue.color.back().name = name;
  }
  const auto parameters = std::make_unique<PipelineParameters>();
  TOUCHLINE_TRY(config::resolve_team(team, where, venue, config::Locations(), config::Markers::kSeen, *parameters));
  out.marker = parameters->marker;
  return out;
}

}  // namespace touchline::calibrate
