#pragma once

#include <string>
#include <vector>

#include "core/types.h"
#include "tests/calibrate/team_picture.h"
#include "tools/programs/calibrate/venue/venue_draft.h"

namespace touchline::calibrate {

/// A picture of the team and its true content.
struct DrawnPicture {
  hal::Picture picture;
  TeamScene scene;
};

/// A randomly drawn team, to which nobody has tuned the calibration: layout, number of robots, paints, floor, lamps and
/// camera follow from a seed.
struct DrawnTeam {
  std::string about;      // description of the drawn values in one line
  std::string team_file;  // text of team.toml
  std::string format;     // value for --format
  config::VenueFile venue;
  std::vector<DrawnPicture> pictures;  // pictures of the same robots at different positions
};

/// Draws `pictures` pictures. The names of the colors are those that a person would use: each paint looks more like its
/// name than like that of another paint, and differs from all others and from the floor. The camera model in `venue` is
/// fitted to points of the field that were clicked on.
DrawnTeam draw_team(unsigned seed, std::size_t pictures);

}  // namespace touchline::calibrate
