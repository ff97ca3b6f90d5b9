#pragma once

#include <cstdint>

#include "core/control/external_command.h"
#include "core/time.h"

namespace touchline {

/// A command of the console is obeyed for this long. The page repeats it at 10 to 20 Hz while a key is held.
inline constexpr Duration kConsoleCommandAge = std::chrono::milliseconds(300);

/// What the guided setup wants of the robots.
enum class SetupWish : std::uint8_t {
  kNone,    // nothing: robots stand only while a draft of the files is in use
  kStand,   // all robots stand
  kPermit,  // robots may move although a draft is in use
};

/// What the clients of the console want; passes through a Mailbox to the loop.
struct ConsoleInput {
  bool stop = false;          // all robots stand until it is false again
  ExternalCommands commands;  // of robots that a client drives; `received` is of CLOCK_MONOTONIC
  std::uint32_t starts = 0;   // number of times that a driver pressed Start
  SetupWish setup = SetupWish::kNone;
};

}  // namespace touchline
