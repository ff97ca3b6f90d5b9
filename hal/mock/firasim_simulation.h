#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "hal/mock/arena_parameters.h"
#include "hal/mock/game_rules.h"
#include "hal/mock/world.h"
#include "hal/poses/firasim_packets.h"
#include "hal/result.h"

namespace touchline::hal::mock {

/// The arena's physics behind FIRASim's packets: a team's program, or Touchline itself with camera.backend = "poses",
/// plays in it as on FIRASim. Knows no socket and no clock. The own team of the arena is the one of its color; the
/// robots of both teams obey commands.
class FirasimSimulation {
 public:
  /// FIRASim's step.
  static constexpr double kStepS = 0.016;
  static constexpr double kWheelRadius_m = 0.02;

  FirasimSimulation(const ArenaParameters& parameters, std::uint64_t seed);

  /// Takes the commands of a Packet, which act from the next step on, and places objects as its `replace` says. Errors
  /// as decode_firasim(); then nothing changes.
  Result<void> receive(std::span<const std::byte> packet);
  /// Advances the world by kStepS.
  void step();
  /// Encodes the Environment after the last step. Returns the number of bytes; 0: `out` is too small.
  std::size_t publish(std::span<std::byte> out) const;

  [[nodiscard]] const World& world() const { return world_; }
  [[nodiscard]] const GameStatistics& statistics() const { return rules_.statistics(); }
  /// Returns the number of commands and placements for robots that do not exist.
  [[nodiscard]] std::uint64_t ignored() const { return ignored_; }

 private:
  void place(const FirasimPlacement& placement);
  [[nodiscard]] FirasimTeam team_of(Side side) const;
  [[nodiscard]] Side side_of(FirasimTeam team) const {
    return team_of(Side::kOwn) == team ? Side::kOwn : Side::kOpponent;
  }

  const ArenaParameters parameters_;
  World world_;
  GameRules rules_;
  Snapshot before_, now_;
  std::uint32_t steps_ = 0;
  std::uint64_t ignored_ = 0;
};

}  // namespace touchline::hal::mock
