#pragma once

#include <string>
#include <vector>

#include "core/pipeline.h"
#include "firmware/config/board_file.h"
#include "firmware/config/locations.h"
#include "firmware/config/resolve.h"
#include "firmware/config/team_file.h"
#include "firmware/config/toml_file.h"
#include "firmware/config/venue_file.h"

namespace touchline::config {

/// Paths of the three files. Without a board file, venue and team must be given.
struct FilePaths {
  std::string board, venue, team;      // empty venue or team: the path in the board file is used
  std::vector<std::string> overrides;  // "key=value", as for --set
};

/// Content of the three files, and the core's parameters derived from it. Large: do not put it on the stack.
struct Configuration {
  BoardFile board;
  VenueFile venue;
  TeamFile team;
  Locations board_where, venue_where, team_where;
  PipelineParameters pipeline;
};

/// Loads the three files. Format and size of the pictures come from the board file. Opens no device. kNotFound: the
/// board file cannot be read; kInconsistent: errors in the files. The message has a line for each error. After
/// kInconsistent, `out` has the values that were read.
Result<void> load(const FilePaths& paths, Configuration& out);

/// Loads the board file alone, for tools that need no venue yet. Errors as for load().
Result<void> load_board(const std::string& path, const std::vector<std::string>& overrides, Configuration& out);

/// Returns the name of the instruction set that classifies the board's pixels, for example "avx2", never "fastest".
/// Empty if the processor does not support it.
std::string_view kernel_word(const BoardFile& board);

/// Loads venue and team alone, for tools that read pictures. Call resolve() when the format of the pictures is known.
Result<void> load_venue_and_team(const FilePaths& paths, Configuration& out);
/// Returns the overrides that load_venue_and_team() accepts: all except those for the board file.
std::vector<std::string> venue_and_team_overrides(const std::vector<std::string>& overrides);
/// Checks venue and team for these pictures and fills `configuration.pipeline`. Errors of resolve_venue() and
/// resolve_team().
Result<void> resolve(const InputFormat& input, Configuration& configuration);

/// Returns the three files as TOML with the values of all keys, including the defaults.
std::string dump(const Configuration& configuration);

}  // namespace touchline::config
