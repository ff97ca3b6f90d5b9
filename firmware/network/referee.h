#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/control/referee_state.h"
#include "firmware/network/messages.h"
#include "hal/result.h"

// Decoders of the leagues' referees. They do not set RefereeState::received.
namespace touchline::network {

/// Height of a team's markers above the floor.
struct TeamHeight {
  std::string team;
  float height_m = 0.0f;
};

/// Settings by which the names of the referee's teams are understood.
struct RefereeSettings {
  std::string own_team;  // name as the referee writes it; empty: color and side are not taken from the referee
  std::vector<TeamHeight> heights;
};

/// Orders the messages of one sender.
struct RefereeOrder {
  std::uint32_t counter = 0;   // counter of commands
  std::uint64_t stamp_us = 0;  // Unix time at which the message was sent
  std::uint64_t source = 0;    // hash of the identifier that a sender keeps while it runs; 0: the sender has none
};

struct RefereeMessage {
  RefereeState state;
  std::optional<RefereeOrder> order;  // nullopt: the referee sends only when something changes
};

/// Decodes the SSL game controller's Referee (docs/network.md). Case and surrounding spaces of names are ignored. Color
/// and side stay unknown if neither team, or both, have the own name; then our color is `our_color`. Errors of
/// decode_message(), and kOutOfRange: the stage or command is unknown.
Result<RefereeMessage> decode_ssl_referee(std::span<const std::byte> bytes, const RefereeSettings& settings,
                                          TeamColor our_color);

/// Decodes the VSSS referee's VSSRef_Command, which contains no assignment of colors and sides. `own`: our color.
/// Older versions have a time stamp instead of a quadrant, and no half. Errors of
/// decode_message(), and kOutOfRange: an unknown foul; kCorruptFrame: an empty datagram, which would be a free kick.
Result<RefereeMessage> decode_vss_referee(std::span<const std::byte> bytes, TeamColor own);

}  // namespace touchline::network
