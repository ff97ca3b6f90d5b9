#pragma once

#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "core/control/controller.h"
#include "hal/mock/game_rules.h"
#include "hal/mock/strategies/strategy_catalog.h"
#include "hal/mock/world.h"

namespace touchline::hal::mock {

/// Own robots at given places, and no opponents.
ArenaParameters arena_of(const std::vector<Placement>& robots);

/// A strategy that drives the own robots of the arena's world, in frames of 16 ms, with perfect tracks and without
/// delay.
class StrategyGame {
 public:
  static constexpr int kStepsPerFrame = 16;

  /// `seed`: of the strategy.
  StrategyGame(const ArenaParameters& arena, std::string_view strategy, std::uint64_t seed = 1);

  void play_frame();
  [[nodiscard]] const World& world() const { return *world_; }
  [[nodiscard]] Vector2 ball() const { return at(snapshot_.ball); }
  [[nodiscard]] Vector2 robot(std::size_t index) const { return at(snapshot_.robots[index]); }
  [[nodiscard]] const GameStatistics& statistics() const { return rules_->statistics(); }
  [[nodiscard]] double time_s() const { return time_s_; }
  [[nodiscard]] Tracks tracks() const;
  void place_ball(const Placement& place, Vector2 velocity_mps = {}) {
    rules_->place_ball(place, velocity_mps);
    before_ = snapshot_ = world_->snapshot();
  }
  /// Last commands.
  [[nodiscard]] const Commands& commands() const { return commands_; }

 private:
  static Vector2 at(const Placement& place) { return {place.x_m, place.y_m}; }
  ArenaParameters arena_;
  std::unique_ptr<World> world_;
  std::unique_ptr<GameRules> rules_;
  Controller controller_;
  StrategyPointer strategy_;  // after the controller, which it configures
  Snapshot before_, snapshot_;
  Commands commands_;
  double time_s_ = 0.0;
};

}  // namespace touchline::hal::mock
