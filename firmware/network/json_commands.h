#pragma once

#include <cstddef>
#include <span>

#include "firmware/network/messages.h"
#include "hal/result.h"

namespace touchline::network {

// Limits of the values; larger ones are rejected as errors. The limits of the drive are applied later.
inline constexpr double kMaxJsonSpeed_mps = 10.0, kMaxJsonTurn_radps = 100.0;
// Limit of a coordinate; the largest field is 30 m long.
inline constexpr double kMaxJsonPosition_m = 20.0;

/// Decodes commands in JSON (docs/network.md):
///   {"commands":[{"id":1,"v":0.3,"w":0}, {"id":2,"left":0.2,"right":0.3},
///                {"id":3,"x":0.1,"y":-0.2,"theta":1.57}, {"id":4,"release":true}]}
/// Each element has the id and one kind of command. Anything else is an error, and then no command of the datagram
/// counts. The text names the place: `commands[2].v = 12 is not within -10 to 10`. kCorruptFrame: the text is no JSON;
/// kOutOfRange: a value is out of range; kInconsistent: keys are unknown, missing, repeated, or of several kinds.
Result<CommandBatch> decode_json_commands(std::span<const std::byte> bytes);

}  // namespace touchline::network
