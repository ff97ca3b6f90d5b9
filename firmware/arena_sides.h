#pragma once

#include <cstdint>
#include <memory>

#include "firmware/config/configuration.h"
#include "hal/mock/simulated_side.h"
#include "hal/result.h"

namespace touchline {

/// Returns how a side of the configured arena plays without pictures: with the camera's rate and latency, the radio's
/// delays, and the team's control. The opponents' robots understand Touchline's own packet.
hal::mock::SideSettings side_settings(const config::Configuration& configuration, hal::mock::Side side);

/// Creates the arena's other team as the board file says (arena.opponents); null: it stands. kOutOfRange: the team
/// file's settings are impossible with opponent_speed_mps.
Result<std::unique_ptr<hal::mock::SimulatedSide>> make_opponents(const config::Configuration& configuration,
                                                                 std::uint64_t seed);

}  // namespace touchline
