#pragma once

#include <string>
#include <string_view>

#include "core/pipeline.h"
#include "firmware/config/locations.h"
#include "firmware/config/team_file.h"
#include "firmware/config/venue_file.h"
#include "hal/result.h"

namespace touchline::config {

/// Format of the pictures from the camera or the replay.
struct InputFormat {
  PixelFormat format = PixelFormat::kRgb24;
  std::uint16_t width_px = 0, height_px = 0;
  std::string source;       // for messages: "the camera of boards/mock/board.toml", or a folder
  std::string_view word{};  // word of camera.format for messages; empty: the word of `format`
};

/// Fills the parameters that the venue defines: scan, camera, field. Reads the light map. Color ids count from 1 in the
/// order of the file. kInconsistent: values contradict each other; the message has a line for each contradiction.
Result<void> resolve_venue(const VenueFile& venue, const Locations& where, const InputFormat& input,
                           PipelineParameters& out);

/// Whether robots are recognized by their markers. Otherwise a source of poses knows them by their ids, and robots need
/// no colors.
enum class Markers : std::uint8_t { kSeen, kUnseen };

/// Fills the parameters that the team file defines: markers, ball, tracking (with the venue's noise added), control.
/// Colors are found in the venue by name. Errors as of resolve_venue().
Result<void> resolve_team(const TeamFile& team, const Locations& where, const VenueFile& venue,
                          const Locations& venue_where, Markers markers, PipelineParameters& out);

/// Returns the id of a color, or kBackground (0) if the venue has no such color.
ColorId color_id(const VenueFile& venue, std::string_view name);

}  // namespace touchline::config
