#pragma once

#include <cstddef>
#include <span>

#include "core/geometry/field_area.h"
#include "firmware/network/messages.h"
#include "hal/result.h"

namespace touchline::network {

/// Encodes FIRASim's Environment (docs/network.md): filtered poses and velocities in meters and radians. Robots are
/// sorted by id; robots of unknown id and a lost ball are left out. Returns the number of bytes; 0: `out` is too small.
std::size_t encode_firasim_environment(const OutputFrame& frame, const FieldParameters& field,
                                       std::span<std::byte> out);

// Limit of a rim's speed; higher values are reduced to it. No robot of the leagues reaches it.
inline constexpr float kMaxRimSpeed_mps = 10.0f;

/// Decodes FIRASim's Packet: wheel speeds in rad/s, times `wheel_radius_m`. Ignores commands for the other color, and
/// `replace`. Errors of decode_message(), and kOutOfRange: an id above 127, a speed that is not finite, more robots
/// than a team has.
Result<CommandBatch> decode_firasim_packet(std::span<const std::byte> bytes, TeamColor own, float wheel_radius_m);

}  // namespace touchline::network
