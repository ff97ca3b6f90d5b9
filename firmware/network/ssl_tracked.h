#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "firmware/network/messages.h"

namespace touchline::network {

/// Name of the source in the tracked packets.
inline constexpr std::string_view kSourceName = "Touchline";

/// Returns a random UUID (version 4, RFC 4122). A publisher keeps it as long as it runs.
std::string random_uuid();

/// Encodes a TrackerWrapperPacket (docs/network.md): filtered poses and velocities in meters and radians at the capture
/// time. Robots of unknown id are left out, because the message has no place for them. `uuid` has 36 characters.
/// Returns the number of bytes; 0 if `out` is too small.
std::size_t encode_ssl_tracked(const OutputFrame& frame, std::string_view uuid, std::span<std::byte> out);

}  // namespace touchline::network
