#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "firmware/arena_loop.h"
#include "firmware/arena_sides.h"
#include "firmware/config/configuration.h"
#include "hal/mock/arena.h"

namespace touchline::evaluate {

/// Reports of the pipeline about one frame.
struct GameFrame {
  Instant capture_time{};
  RobotSightings sightings;
  BallSighting ball;
  Tracks tracks;
};

/// Clock of the arena that records the poses of all objects every millisecond.
class RecordingClock : public hal::Clock {
 public:
  explicit RecordingClock(hal::mock::Arena& arena) : arena_(arena) { truth_.push_back(arena.world().snapshot()); }
  [[nodiscard]] Instant now() const override { return arena_.now(); }
  void sleep_until(Instant instant) override;

  /// Returns true if the poses between `instant` - margin and `instant` + margin were recorded.
  [[nodiscard]] bool covers(Instant instant, Duration margin) const;
  /// Returns the poses at `instant`, interpolated linearly; covers(instant, 0) must be true.
  [[nodiscard]] hal::mock::Snapshot at(Instant instant) const;

 private:
  hal::mock::Arena& arena_;
  std::vector<hal::mock::Snapshot> truth_;  // entry k: k milliseconds after the arena's start
};

/// A game in a board's arena, played by the real loop or without pictures, together with its ground truth. Large: do
/// not put it on the stack.
class RecordedGame {
 public:
  /// Errors of config::load(). kInconsistent: the board's camera or radio is not the arena.
  Result<void> load(const config::FilePaths& files, std::uint64_t seed);
  /// Loads a game in which the own side sees the arena without pictures (hal::mock::SimulatedSide); drive() is ignored.
  /// Errors as load().
  Result<void> load_without_pictures(const config::FilePaths& files, std::uint64_t seed);
  /// Continues the game for `duration_s` and records its frames. Errors: any error of the loop's devices.
  Result<void> play(double duration_s) { return play(duration_s, true); }
  /// Continues the game without recording, for example until tracks are confirmed and robots drive.
  Result<void> skip(double duration_s) { return play(duration_s, false); }
  /// Sets the own robots that other programs drive until the next call. The built-in play drives all own robots before
  /// the first call, and robots that `commands` does not list.
  void drive(const ExternalCommands& commands) { commands_ = commands; }
  /// Hides every robot from the own side again and again, each for `for_s` > 0 and then not for as long and kSeen_s
  /// more, from now on for `duration_s`. The robots' turns are spread evenly, so that the others are seen meanwhile.
  void hide_robots(double for_s, double duration_s);
  static constexpr double kSeen_s = 0.7;

  [[nodiscard]] const config::Configuration& configuration() const { return *configuration_; }
  [[nodiscard]] hal::mock::World& world() { return arena_->world(); }
  [[nodiscard]] const hal::mock::Arena& arena() const { return *arena_; }
  [[nodiscard]] const RecordingClock& truth() const { return *clock_; }
  [[nodiscard]] const std::vector<GameFrame>& frames() const { return frames_; }

 private:
  Result<void> load_arena(const config::FilePaths& files, std::uint64_t seed);
  Result<void> play(double duration_s, bool record);
  void record(const StepTrace& trace);
  static void observe(void* context, const StepTrace& trace, const StepTiming& timing);

  std::unique_ptr<config::Configuration> configuration_ = std::make_unique<config::Configuration>();
  std::unique_ptr<Mailbox<ExternalCommands>> mailbox_ = std::make_unique<Mailbox<ExternalCommands>>();
  std::optional<ExternalCommands> commands_;
  ArenaOpponents opponents_;
  std::unique_ptr<hal::mock::SimulatedSide> side_;  // null: the loop plays
  std::optional<hal::mock::Arena> arena_;
  std::optional<RecordingClock> clock_;
  std::optional<ArenaLoop> loop_;  // after arena and clock, which it uses
  std::vector<GameFrame> frames_;
  bool records_ = false;
};

}  // namespace touchline::evaluate
