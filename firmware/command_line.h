#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "firmware/console/console_plan.h"
#include "firmware/exit_codes.h"
#include "firmware/init_command.h"
#include "firmware/link_command.h"
#include "firmware/network/network_plan.h"
#include "firmware/session.h"

namespace touchline {

enum class Command : std::uint8_t { kRun, kCheck, kKeys, kFaults, kInit, kConsole, kLink, kRadio };
/// How fast simulated time passes. kDefault means kReal if somebody watches or a program is connected, otherwise kFast.
enum class Pace : std::uint8_t { kDefault, kReal, kFast };

struct CommandLine {
  Command command = Command::kRun;
  SessionOptions session;
  network::NetworkOptions network;
  console::ConsoleOptions console;
  Pace pace = Pace::kDefault;
  std::string recordings;  // folder of run --record; empty: the board file decides
  bool headless = false;
  bool dump = false;
  bool prints_login_link = false;      // console --link was given
  std::string drawing;                 // file of check --draw
  std::vector<std::string> key_words;  // words of keys WORD...
  std::string page_to_update;          // page of keys --update, faults --update
  InitOptions init;
  LinkOptions link;
  std::string radio_format;  // radio NAME
};

/// Parses the command line. An empty result means: continue with `out`. Otherwise help, version or an error has been
/// printed, and the value is the exit code.
std::optional<int> parse_command_line(int argc, char** argv, CommandLine& out);

}  // namespace touchline
