#pragma once

#include <cstdint>

#include "firmware/session.h"

namespace touchline {

// What the program's end tells a script.
inline constexpr int kExitOk = 0;
inline constexpr int kExitBadConfiguration = 1;
inline constexpr int kExitDeviceFailure = 2;
inline constexpr int kExitBadCommandLine = 64;  // EX_USAGE of sysexits.h

enum class Command : std::uint8_t { kRun, kCheck, kKeys };

struct CommandLine {
  Command command = Command::kRun;
  SessionOptions session;
  bool headless = false;
  bool dump = false;
};

/// True: go on with `out`. False: help, version or an error was printed, leave with `exit_code`.
bool parse_command_line(int argc, char** argv, CommandLine& out, int& exit_code);

}  // namespace touchline
