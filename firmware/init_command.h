#pragma once

#include <string>
#include <vector>

#include "firmware/device_list/device_list.h"
#include "hal/result.h"

namespace touchline {

/// Options of `touchline init`.
struct InitOptions {
  std::string league, folder = ".";
  bool force = false;  // replace existing files
};

/// Returns the names of the leagues.
std::vector<std::string> init_leagues();

/// Writes board.toml, venue.toml and team.toml to start from into the folder, which is created if necessary, and
/// returns the next steps for the terminal. The board file gets the first camera and USB serial port of `found`, and
/// names the others in comments. kInconsistent: a file exists and `force` is false; nothing is written. Other errors
/// are those of hal::write_file().
Result<std::string> write_initial_files(const InitOptions& options, const devices::DeviceList& found);

}  // namespace touchline
