#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "firmware/config/console_settings.h"
#include "firmware/config/locations.h"
#include "hal/result.h"

namespace touchline::console {

/// Options of the command line.
struct ConsoleOptions {
  bool is_requested = false;    // --console or --lan was given
  bool is_for_network = false;  // --lan was given
  std::string address;          // address given with --console; "": the board file's
};

/// Whether and where the console is served: combines [console] of the board file with the command line.
struct ConsolePlan {
  bool is_enabled = false;
  std::string address;  // IPv4 address in numbers
  std::uint16_t port = 0;
  std::string token_file;
  // True for a person at the terminal, false for a service. If true, a missing token is created, and the next port is
  // tried if one is in use.
  bool is_interactive = false;
  std::vector<std::string> hosts, origins;
  double picture_rate_hz = 0.0;
  std::string setup_socket;
};

/// Returns the token file of the board if this user may read or make it, otherwise one in the user's state folder.
std::string usable_token_file(const config::ConsoleSettings& board);

/// kOutOfRange: the address is not ADDRESS:PORT; the message says where it was given.
Result<ConsolePlan> plan_console(const config::ConsoleSettings& board, const config::Locations& where,
                                 const ConsoleOptions& options);

}  // namespace touchline::console
