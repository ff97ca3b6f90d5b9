#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "hal/result.h"
#include "tools/programs/calibrate/venue/venue_draft.h"

namespace touchline::setup {

/// Returns `steps.robots` of the page's state: layouts, both teams, errors of the team file, and for each team the
/// pairs of robots whose identification colors are closest in this venue.
nlohmann::json robots_state(const std::string& team_path, const calibrate::VenueDraft& venue);

/// Returns the text of the team file with this [[layout]], which replaces one of the same name: {name, robot_side_m,
/// height_m, patches: [{role, outline, x_m, y_m, length_m, width_m, turn_rad}]}. Errors as replace_team().
Result<std::string> replace_layout(const std::string& text, const nlohmann::json& layout);

/// Returns the text of the team file with [ball]: {color, radius_m}, either may be absent. Errors as replace_team().
Result<std::string> replace_ball(const std::string& text, const nlohmann::json& ball);

/// Returns the text of the team file with [own] or [opponent] as the page has it: {layout, color, robots: [{id,
/// colors}]}. Other keys of the table are kept. kInconsistent: the table has another form.
Result<std::string> replace_team(const std::string& text, const std::string& name, const nlohmann::json& table);

}  // namespace touchline::setup
