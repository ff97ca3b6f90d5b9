#pragma once

#include <string_view>

#include "core/types.h"

// Words and numbers of docs/console-protocol.md.
namespace touchline::console {

/// Increases when a member of a message changes its meaning or disappears.
inline constexpr int kProtocol = 1;
/// The WebSocket subprotocol.
inline constexpr const char* kSubprotocol = "touchline.1";
// Subprotocol of a page's second connection, which carries only Stop.
inline constexpr const char* kStopSubprotocol = "touchline.stop.1";

constexpr std::string_view word_of(Team team) { return team == Team::kOwn ? "own" : "opponent"; }

}  // namespace touchline::console
