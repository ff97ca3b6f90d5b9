#pragma once

#include <cstdint>
#include <optional>
#include <string>

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

/// Empty: continue with `out`. Otherwise help, version or an error has been printed, and the value is the exit code.
std::optional<int> parse_command_line(int argc, char** argv, CommandLine& out);

}  // namespace touchline
