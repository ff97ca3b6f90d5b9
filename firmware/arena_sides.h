#pragma once

#include <cstdint>
#include <memory>

#include "firmware/config/configuration.h"
#include "hal/mock/simulated_side.h"
#include "hal/mock/strategies/strategy_catalog.h"
#include "hal/result.h"

namespace touchline {

/// Returns how a side of the configured arena plays without pictures: with the camera's rate and latency, the radio's
/// delays, and the team's control. The opponents' robots understand Touchline's own packet.
hal::mock::SideSettings side_settings(const config::Configuration& configuration, hal::mock::Side side);

/// The arena's other team, which the board file describes (arena.opponents). Nobody plays if it stands.
struct ArenaOpponents {
  hal::mock::StrategyPointer strategy{nullptr, nullptr};
  std::unique_ptr<hal::mock::SimulatedSide> side;  // null: it stands
};
/// kOutOfRange: the team file's settings are impossible with arena.opponent_speed_mps.
Result<ArenaOpponents> make_opponents(const config::Configuration& configuration, std::uint64_t seed);

}  // namespace touchline
