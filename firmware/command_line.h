#pragma once

#include <cstdint>

#include "firmware/exit_codes.h"
#include "firmware/session.h"

namespace touchline {

enum class Command : std::uint8_t { kRun, kCheck, kKeys };

struct CommandLine {
  Command command = Command::kRun;
  SessionOptions session;
  bool headless = false;
  bool dump = false;
  std::string page_to_update;  // keys --update
};

/// Returns true with the result in `out`, or false if help, version or an error was printed: end with `exit_code`.
bool parse_command_line(int argc, char** argv, CommandLine& out, int& exit_code);

}  // namespace touchline
