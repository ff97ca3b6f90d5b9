#pragma once

#include <array>
#include <cstdint>

#include "core/time.h"
#include "hal/device_parameters.h"
#include "hal/mock/arena_parameters.h"
#include "hal/mock/game_rules.h"
#include "hal/mock/radio_channel.h"
#include "hal/mock/world.h"

namespace touchline::hal::mock {

class SimulatedSide;

/// A game on one time line: the world, its rules, and for each side the radio link to its robots. Time advances in
/// steps of the world. Packets and time-outs take effect on the first step after their time. The same seed and packets
/// give bit-identical games. Nothing is allocated after construction.
class Game {
 public:
  // Start of the game. It is not zero, so that it differs from an Instant that was never set.
  static constexpr Instant kBegin{std::chrono::seconds(1)};
  static constexpr Duration kStep = std::chrono::milliseconds(1);
  static_assert(seconds(kStep) == World::kStepS);

  /// `radio`: baud rate and pauses of the lines to both sides' radios; `begin`: the instant of arena time 0. The
  /// parameters must have no violation (find_violation()).
  Game(const ArenaParameters& parameters, const RadioSettings& radio, std::uint64_t seed, Instant begin = kBegin);
  Game(const Game&) = delete;
  Game& operator=(const Game&) = delete;
  ~Game() = default;

  /// Lets a simulated side play; it must outlive the game's steps. Null: packets for its robots come from outside, by
  /// RadioChannel::send().
  void set_side(Side side, SimulatedSide* player) { sides_[static_cast<std::size_t>(side)] = player; }

  /// Advances the time by kStep.
  void step();
  /// Makes all steps until `instant`.
  void advance_to(Instant instant) {
    while (now_ + kStep <= instant) step();
  }
  /// Begins the game anew at the present time, with other random numbers: robots and ball are where they were at the
  /// begin, the statistics are zero. The same robots play.
  void restart(std::uint64_t seed);
  /// Call it when robots were put elsewhere: both sides' tracks begin anew with the next frame.
  void note_jump() { jumped_ = true; }
  /// Returns when robots were put elsewhere for the last time; begin() if they never were.
  [[nodiscard]] Instant last_jump() const { return last_jump_; }
  [[nodiscard]] Instant begin() const { return begin_; }
  [[nodiscard]] Instant now() const { return now_; }

  [[nodiscard]] World& world() { return world_; }
  [[nodiscard]] const World& world() const { return world_; }
  [[nodiscard]] GameRules& rules() { return rules_; }
  [[nodiscard]] const GameRules& rules() const { return rules_; }
  [[nodiscard]] const GameStatistics& statistics() const { return rules_.statistics(); }
  [[nodiscard]] RadioChannel& channel(Side side = Side::kOwn) { return channels_[static_cast<std::size_t>(side)]; }
  [[nodiscard]] const RadioChannel& channel(Side side = Side::kOwn) const {
    return channels_[static_cast<std::size_t>(side)];
  }
  [[nodiscard]] std::uint64_t hash() const { return rules_.hash(); }

 private:
  World world_;
  GameRules rules_;
  std::array<RadioChannel, 2> channels_;  // by Side
  std::array<SimulatedSide*, 2> sides_{};
  const Instant begin_;
  Instant now_, last_jump_;
  bool jumped_ = false;  // since the last step
};

}  // namespace touchline::hal::mock
