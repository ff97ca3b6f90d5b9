#pragma once

#include <string>
#include <string_view>

#include "core/pipeline.h"
#include "firmware/config/problems.h"
#include "firmware/config/team_file.h"
#include "firmware/config/venue_file.h"

namespace touchline::config {

/// The pictures that will come: of the board's camera, or of a replayed input.
struct InputFormat {
  PixelFormat format = PixelFormat::kRgb24;
  std::uint16_t width_px = 0, height_px = 0;
  std::string source;  // who says so, for messages: "boards/mock/board.toml:12: camera" or a folder's name
};

/// Fills what the venue says: scan, camera, field. All contradictions go to `problems`; the color ids are 1.. in the
/// file's order. The light map is read from its file.
void resolve_venue(const VenueFile& venue, const Locations& where, const InputFormat& input, PipelineParameters& out,
                   Problems& problems);

/// Fills what the team file says: markers, ball, tracking, control. Colors are looked up in the venue.
void resolve_team(const TeamFile& team, const Locations& where, const VenueFile& venue, const Locations& venue_where,
                  PipelineParameters& out, Problems& problems);

/// 0 (kBackground) when the venue has no such color.
ColorId color_id(const VenueFile& venue, std::string_view name);

}  // namespace touchline::config
