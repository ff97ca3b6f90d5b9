#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "core/step_inputs.h"
#include "core/types.h"
#include "firmware/recording/step_tap.h"
#include "hal/fnv1a.h"
#include "hal/result.h"

namespace touchline::recording {

/// Parts of a step's results, in the order in which they arise. A stop has packets only.
enum class ResultPart : std::uint8_t { kSightings, kTracks, kCommands, kPackets };
inline constexpr std::size_t kResultParts = 4;
constexpr std::string_view word_of(ResultPart part) {
  constexpr std::array<std::string_view, kResultParts> kWords{"sightings", "tracks", "commands", "packets"};
  return kWords[static_cast<std::size_t>(part)];
}

/// The bytes of a step's results, which a replay reproduces bit for bit.
using StepResults = std::array<std::string, kResultParts>;

/// Writes the results of a frame, and of a stop.
void write_results(const Sightings& sightings, const Tracks& tracks, const Commands& commands,
                   const OutgoingPackets& packets, StepResults& out);
void write_results(const OutgoingPackets& packets, StepResults& out);
/// Adds the results to the hash.
void add_to(hal::Fnv1a& hash, const StepResults& results);

/// A step as a recording holds it. Large: do not put it on the stack.
struct StepMessage {
  StepHeader header;
  StepInputs inputs;
  DriveCorrections drives;  // in force
  StepResults results;
  std::string state;  // after the step, as write_state() has written it; empty: not recorded
};

/// Format of the messages that are written. The former one has neither drives nor state; others cannot be replayed.
inline constexpr std::uint8_t kStepFormat = 2, kStepFormatWithoutState = 1;
/// Describes the format for people who look into the file.
std::string_view step_schema();

void encode(const StepMessage& message, std::string& out);
/// kCorruptFrame: the bytes are not such a message; kUnsupported: it is one of another version of Touchline.
Result<void> decode(std::span<const std::byte> bytes, StepMessage& out);
/// Returns the recorded sightings. kCorruptFrame: they cannot be read.
Result<void> decode_sightings(const StepResults& results, Sightings& out);
/// Returns all recorded results of a frame but its packets. kCorruptFrame: they cannot be read.
Result<void> decode_results(const StepResults& results, Sightings& sightings, Tracks& tracks, Commands& commands);

}  // namespace touchline::recording
