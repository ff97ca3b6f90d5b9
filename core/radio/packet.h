#pragma once

#include <cstddef>

#include "core/radio/packet_encoder.h"
#include "core/radio/packet_layout.h"
#include "core/types.h"

namespace touchline {

/// Writes the packets of one frame: one for all robots, or one for each receiver of the layout, as the layout says. A
/// stop contains the same robots with speed zero. A receiver without a command gets speed zero unless the layout lists
/// robots with commands only.
/// kFull: the list of commands has overflowed, or a packet is too large. kOutOfRange: a robot has no id (below 0).
/// kInconsistent: a duplicate id. After an error `out` is empty and nothing must be sent.
Status encode(const PacketLayout& layout, const Commands& commands, const PacketValues& values, OutgoingPackets& out);

}  // namespace touchline
