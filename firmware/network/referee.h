#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "core/control/referee_state.h"
#include "hal/result.h"

// Decoders of the leagues' referees. They give a RefereeState without `received`.
namespace touchline::network {

/// Height of a team's markers above the floor.
struct TeamHeight {
  std::string team;
  float height_m = 0.0f;
};

/// How the referee's names of teams are understood.
struct RefereeSettings {
  std::string own_team;  // as the referee writes it; empty: color and side are not taken from the referee
  std::vector<TeamHeight> heights;
};

/// Decodes the SSL game controller's Referee (docs/network.md). Case and surrounding spaces in names do not count.
/// Color and side stay unknown if neither team, or both, have the own name. Errors of decode_message(), and
/// kOutOfRange: an unknown stage or command.
Result<RefereeState> decode_ssl_referee(std::span<const std::byte> bytes, const RefereeSettings& settings);

/// Decodes the VSSS referee's VSSRef_Command, which says nothing of colors and sides. Errors of decode_message(), and
/// kOutOfRange: an unknown foul; kCorruptFrame: an empty datagram, which would be a free kick.
Result<RefereeState> decode_vss_referee(std::span<const std::byte> bytes);

}  // namespace touchline::network
