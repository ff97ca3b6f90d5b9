#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "firmware/report/trace_json.h"
#include "firmware/snapshot.h"
#include "hal/mock/game.h"
#include "hal/mock/simulated_side.h"
#include "hal/result.h"
#include "tools/programs/simulate/lockstep_message.h"
#include "tools/programs/simulate/team.h"

namespace touchline::simulate {

/// A game without pictures whose time passes only while it is asked to, so that programs outside play as if they took
/// no time. The same messages give the same game bit for bit. Answers are JSON, one line each without its end.
class LockstepGame {
 public:
  /// `overrides`: KEY=VALUE, for all games.
  LockstepGame(std::string board, std::vector<std::string> overrides);
  LockstepGame(const LockstepGame&) = delete;
  LockstepGame& operator=(const LockstepGame&) = delete;
  ~LockstepGame() = default;

  /// Begins a new game and ends the former one, which goes on if this fails. Errors of load_team(), make_player() and
  /// put_objects().
  Result<void> reset(const ResetMessage& message);
  /// Returns the answer to a reset: teams and robots.
  [[nodiscard]] std::string description() const;
  [[nodiscard]] bool has_begun() const { return game_ != nullptr; }
  /// Returns whether a program of its own drives the opponents.
  [[nodiscard]] bool has_other_program() const { return has_other_program_; }
  /// Time since the begin of the game in s.
  [[nodiscard]] double time_s() const;

  /// Takes a program's commands, and what it wants to know. `side`: the side of the program. Nothing changes on error.
  /// kNotFound: the side has no such robot.
  Result<void> begin_step(hal::mock::Side side, const StepMessage& message);
  /// Lets the time pass until a side has all frames of its step.
  void run();
  [[nodiscard]] bool is_done(hal::mock::Side side) const { return player(side).left == 0; }
  /// Returns the frames of a step that is done.
  std::string end_step(hal::mock::Side side);

  /// Errors of put_objects().
  Result<std::string> place(const PlaceMessage& message);
  /// kUnsupported: this kind needs pictures; kNotFound: there is no such robot.
  Result<std::string> inject(const FaultMessage& message);
  [[nodiscard]] std::string hash() const;

 private:
  struct SidePlayer {
    LockstepGame* game = nullptr;
    hal::mock::Side side = hal::mock::Side::kOwn;
    Player player;
    report::TraceNames names;
    bool is_external = false;        // its frames are told to a program
    int left = 0;                    // frames until the step is done
    StepMessage wanted;              // the step in progress
    std::string frames;              // of the step, separated by commas
    hal::mock::GameStatistics told;  // at the last frame of the answer
    std::uint32_t restarts_told = 0;
  };
  [[nodiscard]] SidePlayer& player(hal::mock::Side side) { return players_[static_cast<std::size_t>(side)]; }
  [[nodiscard]] const SidePlayer& player(hal::mock::Side side) const {
    return players_[static_cast<std::size_t>(side)];
  }
  Result<std::shared_ptr<const Team>> team(const std::string& name, const std::vector<std::string>& settings);
  Result<hal::mock::ArenaParameters> arena_of(const Team& own, const ResetMessage& message) const;
  Result<void> check_commands(const ExternalCommands& commands, hal::mock::Side side, const char* list) const;
  void take_commands(const ExternalCommands& commands, hal::mock::Side side);
  void apply_faults();
  void on_step(SidePlayer& player, const StepTrace& trace);
  void write_frame(SidePlayer& player, const StepTrace& trace);
  void write_truth(report::JsonWriter& json, const SidePlayer& player) const;
  void write_events(report::JsonWriter& json, SidePlayer& player) const;

  const std::string board_;
  const std::vector<std::string> overrides_;
  // Reading the files takes longer than a second of a game, and a series of games has the same teams.
  std::map<std::string, std::shared_ptr<const Team>> teams_;
  hal::mock::ArenaParameters arena_;
  std::array<std::string, 2> colors_;  // by Side
  FieldParameters field_;
  double rate_hz_ = 0.0;
  std::array<SidePlayer, 2> players_;
  std::unique_ptr<hal::mock::Game> game_;  // uses players_
  bool has_other_program_ = false;
  std::vector<hal::mock::ArenaFault> faults_;
  Snapshot snapshot_;
  std::vector<char> line_;
};

}  // namespace touchline::simulate
