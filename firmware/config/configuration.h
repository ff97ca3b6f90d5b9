#pragma once

#include <string>
#include <vector>

#include "core/pipeline.h"
#include "firmware/config/board_file.h"
#include "firmware/config/problems.h"
#include "firmware/config/resolution.h"
#include "firmware/config/team_file.h"
#include "firmware/config/toml_file.h"
#include "firmware/config/venue_file.h"

namespace touchline::config {

/// Where the files are. Without a board, venue and team must be given.
struct FilePaths {
  std::string board, venue, team;      // venue, team: relative to the working directory; empty: as the board says
  std::vector<std::string> overrides;  // "key=value", as after --set
};

/// All that the three files say, and what the core is configured with. Large: not for the stack.
struct Configuration {
  BoardFile board;
  VenueFile venue;
  TeamFile team;
  Locations board_where, venue_where, team_where;
  PipelineParameters pipeline;
};

/// Board, venue and team for the firmware. The picture's format and size are the board's.
/// kNotFound, kInconsistent: `problems` has at least one line. What it touches are the files and nothing else.
Status load(const FilePaths& paths, Configuration& out, Problems& problems);

/// The board file alone, for tools that need no venue yet. Errors as load().
Status load_board(const std::string& path, const std::vector<Override>& overrides, Configuration& out,
                  Problems& problems);

/// The word for what classifies the board's pixels: "avx2", never "fastest"; empty where the processor lacks it.
std::string_view kernel_word(const BoardFile& board);

/// Venue and team alone, for tools that bring their own pictures. resolve() must follow once those are known.
Status load_venue_and_team(const FilePaths& paths, Configuration& out, Problems& problems);
/// Venue and team against the pictures that will come.
Status resolve(const InputFormat& input, Configuration& configuration, Problems& problems);

/// Which file a key of `--set` belongs to: by its first part ("camera": board), or said outright ("venue.light.map").
enum class FileKind : std::uint8_t { kBoard, kVenue, kTeam };

/// Splits and sorts overrides; what fits into no file is a problem.
struct SortedOverrides {
  std::vector<Override> board, venue, team;
};
Status sort_overrides(const std::vector<std::string>& texts, SortedOverrides& out, Problems& problems);

/// The three files with all their values, defaults included, as they are in force.
std::string dump(const Configuration& configuration);

}  // namespace touchline::config
