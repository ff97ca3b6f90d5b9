#pragma once

#include <atomic>
#include <cstdint>
#include <optional>

#include "core/control/external_command.h"
#include "core/time.h"
#include "hal/mailbox.h"

namespace touchline {

/// Time for which a command of the console is obeyed. The page repeats the command at 10 to 20 Hz while a key is held.
inline constexpr Duration kConsoleCommandAge = std::chrono::milliseconds(300);
/// Silence of the driver after which the robots stop. The page sends a ping every 0.3 s, so three may be late.
inline constexpr Duration kDriverSilence = std::chrono::seconds(1);

/// Demand of the guided setup on the robots.
enum class SetupWish : std::uint8_t {
  kNone,    // no demand: robots stand only while a draft of the files is in use
  kStand,   // all robots stand
  kPermit,  // robots may move although a draft is in use
};

/// Demands of the console's clients. Times are those at which a message arrived at the socket (CLOCK_MONOTONIC): the
/// loop measures the age of a message itself, so a delay of the console's thread does not hide it.
struct ConsoleInput {
  bool stop = false;          // all robots stand until it is false again
  ExternalCommands commands;  // commands for the robots that a client drives
  SetupWish setup = SetupWish::kNone;
  bool setup_ended = false;        // `stop` is set because the setup was saved or left: nobody has pressed Stop
  std::uint32_t stops = 0;         // how often a client has stopped the robots, including stops while they were stopped
  std::uint32_t starts = 0;        // how often the driver has started them
  std::uint32_t start_number = 0;  // StopRules::held_number() for which the last start was meant
  RobotId tested = kUnknownId;     // robot whose bytes the snapshots carry; kUnknownId: none
  std::optional<Instant> driver_heard{};  // time of the driver's last message; nullopt: nobody drives
};

/// Connects the console with the loops of all sessions of a run. Wait-free for both sides.
struct ConsoleLink {
  Mailbox<ConsoleInput> input;  // from the console to the loop
  // Values that the loop sets.
  std::atomic<std::uint32_t> held_number{0};   // StopRules::held_number()
  std::atomic<bool> is_held{false};            // StopRules::is_held()
  std::atomic<std::uint32_t> starts_taken{0};  // ConsoleInput::starts
};

}  // namespace touchline
