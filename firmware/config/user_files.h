#pragma once

#include <string>

#include "hal/result.h"

namespace touchline::config {

/// Returns the path of a file with the user's state, such as the console's token. The folder is $STATE_DIRECTORY (for a
/// service), or $XDG_STATE_HOME/touchline, by default ~/.local/state/touchline (XDG base directory specification).
std::string user_state_file(const std::string& name);

/// Returns the board file that is used if none is named: board.toml in the working folder, in
/// $XDG_CONFIG_HOME/touchline (by default ~/.config/touchline), or in /etc/touchline. kNotFound: the message names
/// these places and what to do.
Result<std::string> find_board_file();

}  // namespace touchline::config
