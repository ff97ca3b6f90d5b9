#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "firmware/config/configuration.h"
#include "hal/mock/game.h"
#include "hal/mock/random.h"
#include "hal/mock/simulated_side.h"
#include "hal/result.h"

namespace touchline::control_evaluation {

/// What differs from the board file in one drill.
struct DrillSettings {
  int own = 1, opponents = 0;
  std::uint64_t seed = 1;
  double rate_hz = 60.0;
  std::optional<double> true_delay_s;      // of the radio, without jitter; nullopt: as in the board file
  std::optional<double> believed_delay_s;  // nullopt: the true one
  std::optional<double> max_speed_mps;
  bool strict = false;           // control.avoid = "strict"
  Strategy* strategy = nullptr;  // of the own side; null: only commands of "other programs" move robots
};

/// Robots in the arena that one program drives, without the rules of a game: sightings, tracker, controller, packets,
/// radio and simulated robots are those of a game.
class Drill {
 public:
  static Result<std::unique_ptr<Drill>> make(const config::Configuration& configuration, const DrillSettings& settings);

  [[nodiscard]] hal::mock::World& world() { return game_->world(); }
  [[nodiscard]] hal::mock::SimulatedSide& side(hal::mock::Side side) { return *sides_[static_cast<std::size_t>(side)]; }
  [[nodiscard]] double time_s() const { return seconds(game_->now() - game_->begin()); }
  [[nodiscard]] Instant begin() const { return game_->begin(); }
  [[nodiscard]] Instant now() const { return game_->now(); }
  /// Advances by one millisecond. The commands of other programs are always as recent as this instant.
  void step();
  void wait(double time_s);
  /// Lets a robot drive to a pose in its own side's coordinates.
  void go(hal::mock::Side side, RobotId id, Vector2 place, std::optional<double> heading_rad);
  void release(hal::mock::Side side) { side_commands(side).clear(); }
  /// Mean time from a moment until the first command that knows it acts: half a frame period, frame, packet and radio.
  [[nodiscard]] double mean_reaction_s() const { return mean_reaction_s_; }

 private:
  Drill() = default;
  ExternalCommands& side_commands(hal::mock::Side side) {
    return sides_[static_cast<std::size_t>(side)]->inputs().commands;
  }

  std::unique_ptr<hal::mock::Game> game_;
  std::array<std::unique_ptr<hal::mock::SimulatedSide>, 2> sides_;
  double mean_reaction_s_ = 0.0;
};

/// A place on the field at least `margin_m` from the walls.
Vector2 random_place(hal::mock::Random& random, const hal::mock::ArenaParameters& arena, double margin_m);

/// The value below which this share lies; NaN for an empty list.
double quantile(std::vector<double> values, double share);

}  // namespace touchline::control_evaluation
