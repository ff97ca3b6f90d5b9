#pragma once

#include "core/control/external_command.h"
#include "core/time.h"

namespace touchline {

/// A command of the console is obeyed for this long. The page repeats it at 10 to 20 Hz while a key is held.
inline constexpr Duration kConsoleCommandAge = std::chrono::milliseconds(300);

/// What the clients of the console want; passes through a Mailbox to the loop.
struct ConsoleInput {
  bool stop = false;          // all robots stand until it is false again
  ExternalCommands commands;  // of robots that a client drives; `received` is of CLOCK_MONOTONIC
};

}  // namespace touchline
