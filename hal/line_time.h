#pragma once

#include <cstddef>

#include "core/time.h"
#include "core/types.h"

namespace touchline::hal {

/// What packets take on a radio's line: each byte with start and stop bit, and the pause after each packet that the
/// robots need to tell packets apart. Zero without a line.
struct LineTime {
  Duration byte{}, pause{};

  [[nodiscard]] Duration of(std::size_t bytes) const { return static_cast<Duration::rep>(bytes) * byte; }
  /// Returns the time from the start of the first packet until the last byte of packet `index` has been sent.
  [[nodiscard]] Duration until_sent(const OutgoingPackets& packets, std::size_t index) const {
    Duration time = static_cast<Duration::rep>(index) * pause;
    for (std::size_t i = 0; i <= index && i < packets.size(); ++i) time += of(packets[i].packet.size());
    return time;
  }
};

}  // namespace touchline::hal
