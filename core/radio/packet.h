#pragma once

#include <cstdint>
#include <span>

#include "core/types.h"

namespace touchline {

/// Writes all commands into one packet (docs/radio.md). kFull: more robots than a packet holds.
Status encode(const Commands& commands, std::uint8_t sequence, Packet& out);

/// What a robot (or the mock arena) does with it. kCorruptFrame: wrong start, length or checksum.
Status decode(std::span<const std::byte> bytes, Commands& commands, std::uint8_t& sequence);

}  // namespace touchline
