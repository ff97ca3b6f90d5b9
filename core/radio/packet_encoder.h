#pragma once

#include <cstdint>
#include <span>

#include "core/radio/packet_layout.h"
#include "core/time.h"
#include "core/types.h"

namespace touchline {

/// What a packet says of one robot, in SI units.
struct RobotValues {
  RobotId id = kUnknownId;
  std::uint64_t address = 0;
  WheelSpeeds wheels;
  float battery_v = 0.0f;                   // 0: not measured
  std::int8_t link_percent = kLinkUnknown;  // is sent as 255 if it is not known
};

/// What a packet says beside its robots.
struct PacketValues {
  bool stop = false;           // all speeds are sent as 0
  bool start = false;          // with the layout's bytes for the start before the packet
  std::uint32_t sequence = 0;  // a field has its lowest bits
  Instant time{};
};

/// Writes one packet with its framing. A speed that is not a number is sent as 0. kFull: the packet is larger than
/// kMaxPacketBytes; `out` is empty then.
Status encode_packet(const PacketLayout& layout, std::span<const RobotValues> robots, const PacketValues& values,
                     Packet& out);

/// Share of the PWM range, -1 to 1, that drives a wheel at `speed_mps`; and the reverse. Below 0.5 mm/s it is 0.
double pwm_share(const PacketLayout& layout, double speed_mps);
double speed_of_share(const PacketLayout& layout, double share);

}  // namespace touchline
