#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "hal/mock/game.h"
#include "hal/result.h"
#include "tools/programs/simulate/team.h"

namespace touchline::simulate {

/// How the own side sees the game. The opponents never have pictures, as in `touchline run`.
enum class OwnView : std::uint8_t {
  kSightings,  // the robots' and the ball's places with the errors of arena.view (hal::mock::SimulatedSide)
  kPictures,   // rendered pictures, with the firmware's loop (ArenaLoop)
};

/// A game of two teams. The same arguments give the same game bit for bit.
class TeamGame {
 public:
  /// `arena`: parameters of the game, for example fair_arena(). The teams must outlive the game. Errors of
  /// make_player(), and with pictures of ArenaLoop::open(); kInconsistent: pictures of a camera that is not the
  /// arena's.
  static Result<std::unique_ptr<TeamGame>> begin(const hal::mock::ArenaParameters& arena, const Team& own,
                                                 const Team& opponent, std::uint64_t seed, OwnView view);
  TeamGame(const TeamGame&) = delete;
  TeamGame& operator=(const TeamGame&) = delete;
  ~TeamGame();

  /// Lets the time pass until `time_s` after the begin; with pictures, until the first frame that is in memory after
  /// that. An error if the loop with pictures ends.
  Result<void> advance_to(double time_s);
  [[nodiscard]] double time_s() const { return seconds(game().now() - game().begin()); }
  [[nodiscard]] const hal::mock::Game& game() const { return *game_; }
  [[nodiscard]] const Strategy& strategy(hal::mock::Side side) const {
    return *players_[static_cast<std::size_t>(side)].strategy;
  }

 private:
  struct Pictures;  // arena and loop of the own side
  TeamGame();
  Result<void> begin_with_pictures(const hal::mock::ArenaParameters& arena, const Team& own, std::uint64_t seed);

  std::array<Player, 2> players_;  // by Side; with pictures, the own one has no simulated side
  std::unique_ptr<hal::mock::Game> owned_game_;
  std::unique_ptr<Pictures> pictures_;  // null: there are no pictures
  hal::mock::Game* game_ = nullptr;     // of either
};

}  // namespace touchline::simulate
