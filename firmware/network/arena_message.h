#pragma once

#include <string_view>

#include "firmware/arena_places.h"
#include "firmware/network/json_members.h"
#include "hal/mock/arena_parameters.h"

// The parts of messages that control a simulation (docs/arena.md), for `touchline run` and `touchline-simulate serve`.
namespace touchline::network {

/// Reads the member `seed`: 0 to 2^53.
std::uint64_t read_seed(JsonMembers& members);

/// Reads {"ball": {"x": 0, "y": 0, "vx": 1, "vy": 0}, "robots": {"blue": {"3": {"x": 0, "y": 0, "theta": 0}}}}: the
/// members of a frame, whose other members are ignored where a frame has them.
ArenaPlaces read_places(JsonMembers& places);
/// Reads {"vx": 1, "vy": 0, "x": 0, "y": 0}; the ball is thrown from where it is without x and y.
PlacedBall read_throw(JsonMembers& members);
/// Reads {"kind": "radio_lost", "for_s": 1, "at_s": 3}; `at_s` is counted from now, and 0 if it is absent. "hide_robot"
/// also has {"team": "own", "id": 2}; whether this robot exists is not checked.
hal::mock::ArenaFault read_fault(JsonMembers& members);

/// Reads a request with one member: {"reset": {"seed": 2}}, {"place": ...}, {"throw": ...}, {"pause": {}},
/// {"move": {"u_px": 1, "v_px": 2, "to_u_px": 3, "to_v_px": 4}}, {"resume": {}}, {"step": {"frames": 1}},
/// {"speed": {"factor": 2}} or {"fault": {"kind": "dark", "for_s": 1}}.
ArenaRequest read_arena_request(JsonMembers& members);
/// Returns the request that moves the object at this pixel.
ArenaRequest move_request(PixelPoint from, PixelPoint to);
/// Reads a message that is such a request. Errors name the member and its value.
Result<ArenaRequest> decode_arena_request(std::string_view text);
/// Returns whether the message is to be read by decode_arena_request(), not by decode_json_commands().
bool is_arena_request(std::string_view text);

}  // namespace touchline::network
