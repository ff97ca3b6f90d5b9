#pragma once

#include <atomic>
#include <cstdint>
#include <optional>

#include "core/control/external_command.h"
#include "core/time.h"
#include "hal/mailbox.h"

namespace touchline {

/// A command of the console is obeyed for this long. The page repeats it at 10 to 20 Hz while a key is held.
inline constexpr Duration kConsoleCommandAge = std::chrono::milliseconds(300);
/// A driver that is silent for longer stops the robots. The page sends a ping every 0.3 s: three may be late.
inline constexpr Duration kDriverSilence = std::chrono::seconds(1);

/// What the guided setup wants of the robots.
enum class SetupWish : std::uint8_t {
  kNone,    // nothing: robots stand only while a draft of the files is in use
  kStand,   // all robots stand
  kPermit,  // robots may move although a draft is in use
};

/// What the clients of the console want. Times are of CLOCK_MONOTONIC, and those at which a message arrived at the
/// socket: the loop measures their ages itself, whatever the console's thread is doing.
struct ConsoleInput {
  bool stop = false;          // all robots stand until it is false again
  ExternalCommands commands;  // of robots that a client drives
  SetupWish setup = SetupWish::kNone;
  bool setup_ended = false;               // `stop` is set because the setup was saved or left: nobody has pressed Stop
  std::uint32_t stops = 0;                // how often a client has stopped the robots, also while they were stopped
  std::uint32_t starts = 0;               // how often the driver has started them
  std::uint32_t start_number = 0;         // of the last start: the StopRules::held_number() that it is meant for
  std::optional<Instant> driver_heard{};  // the driver's last message; nullopt: nobody drives
};

/// Between the console and the loops of all sessions of a run. Wait-free for both sides.
struct ConsoleLink {
  Mailbox<ConsoleInput> input;  // to the loop
  // From the loop.
  std::atomic<std::uint32_t> held_number{0};   // StopRules::held_number()
  std::atomic<bool> is_held{false};            // StopRules::is_held()
  std::atomic<std::uint32_t> starts_taken{0};  // ConsoleInput::starts
};

}  // namespace touchline
