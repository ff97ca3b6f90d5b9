#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/config/configuration.h"
#include "hal/mock/simulated_side.h"
#include "hal/mock/strategies/strategy_catalog.h"
#include "hal/result.h"

namespace touchline::simulate {

/// What drives one side: a strategy by its name, or a team file, whose settings the built-in play uses.
struct Team {
  std::string name;  // as given on the command line
  std::shared_ptr<const config::Configuration> configuration;
  std::string strategy;  // its name
};

/// Returns the names of all strategies with a line of description each, for --help.
std::string strategies_text();
std::vector<std::string> strategy_names();

/// Returns the overrides (KEY=VALUE) with which both sides play on the robots of a parameter set (arena.preset) that
/// the tracker and the play know. Fails for a set that does not exist.
Result<std::vector<std::string>> preset_overrides(std::string_view preset);

/// Reads the files of a side. `team`: the name of a strategy, or the path of a team file, which ends in ".toml".
/// `overrides`: KEY=VALUE. Errors of config::load(); kNotFound: there is no such strategy.
Result<Team> load_team(const std::string& board, const std::string& team, const std::vector<std::string>& overrides);

/// Makes the team's strategy for one game. Errors of StrategyCatalog::create().
Result<hal::mock::StrategyPointer> make_strategy(const Team& team, std::uint64_t seed);
/// Returns the team's control parameters, with the limits of the drive that its strategy wants.
ControlParameters control_of(const Team& team);

/// A side that is ready to play one game without pictures.
struct Player {
  hal::mock::StrategyPointer strategy{nullptr, nullptr};
  std::unique_ptr<hal::mock::SimulatedSide> side;
};

/// Creates the player of one game. `arena`: parameters of the game. Errors of SimulatedSide::configure().
Result<Player> make_player(const Team& team, const hal::mock::ArenaParameters& arena, hal::mock::Side side,
                           std::uint64_t seed);

}  // namespace touchline::simulate
