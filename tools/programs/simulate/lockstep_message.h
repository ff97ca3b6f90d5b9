#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/control/external_command.h"
#include "firmware/arena_places.h"
#include "hal/mock/arena_parameters.h"
#include "hal/result.h"

// The messages of a program that owns the time of a game (docs/arena.md, "Lock-step").
namespace touchline::simulate {

/// Limit of a message, for places of all robots and many settings.
inline constexpr std::size_t kMaxLockstepBytes = 65536;
/// Frames of one step: ten seconds at 60 frames per second.
inline constexpr int kMaxStepFrames = 600;

/// Who drives a side, beside strategies and team files: the program of this connection, or that of another one.
inline constexpr std::string_view kExternal = "external", kOtherProgram = "program";

/// Begins a new game.
struct ResetMessage {
  std::uint64_t seed = 1;
  std::string own{kExternal}, opponent = "stand";
  int robots = 0;  // of each side; 0: all of the board file
  bool robots_return = true;
  std::vector<std::string> settings;  // "KEY=VALUE"
  ArenaPlaces places;
  std::vector<hal::mock::ArenaFault> faults;
};

/// Lets the time pass until the program's side has processed so many frames.
struct StepMessage {
  int frames = 1;
  ExternalCommands commands, opponent_commands;  // their times of reception are not set
  bool only_last = false;                        // the answer has the last frame alone
  bool truth = false, sightings = false;         // the answer's frames have these members
};

struct PlaceMessage {
  ArenaPlaces places;
};
struct FaultMessage {
  hal::mock::ArenaFault fault;  // `at_s` is counted from now
};
struct HashMessage {};

using LockstepMessage = std::variant<ResetMessage, StepMessage, PlaceMessage, FaultMessage, HashMessage>;

/// Reads a message of any content. Errors name the member and its value, as those of network::JsonMembers and
/// decode_json_commands().
Result<LockstepMessage> parse_lockstep_message(std::string_view text);

}  // namespace touchline::simulate
