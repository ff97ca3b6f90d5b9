#pragma once

#include <cstdint>
#include <optional>

#include "core/time.h"

namespace touchline {

/// Robots play in kNoReferee and kRunning only.
enum class GamePhase : std::uint8_t { kNoReferee, kHalt, kStop, kPrepare, kRunning };

constexpr bool may_play_in(GamePhase phase) { return phase == GamePhase::kNoReferee || phase == GamePhase::kRunning; }

/// How the game goes on after an interruption. kNone: not known, or the game runs.
enum class Restart : std::uint8_t { kNone, kKickOff, kFreeBall, kPenalty, kGoalKick, kFreeKick };

/// What the robots may do, from nothing to everything.
enum class Permission : std::uint8_t { kStand, kLineUp, kPlay };

/// The referee's decision as one team sees it.
struct GameSituation {
  GamePhase phase = GamePhase::kNoReferee;
  // In kPrepare the restart that follows; in kRunning the one that is being taken.
  Restart restart = Restart::kNone;
  bool ours = false;  // the restart is ours; false for a free ball
  // In kStop and kPrepare robots drive to their places by themselves; otherwise people place them.
  bool lines_up = false;

  friend bool operator==(const GameSituation&, const GameSituation&) = default;
};

constexpr Permission permission_in(GamePhase phase, bool lines_up) {
  if (may_play_in(phase)) return Permission::kPlay;
  return lines_up && phase != GamePhase::kHalt ? Permission::kLineUp : Permission::kStand;
}
constexpr Permission permission_in(const GameSituation& situation) {
  return permission_in(situation.phase, situation.lines_up);
}

/// Goals of both teams.
struct Score {
  std::uint32_t own = 0, opponent = 0;

  friend bool operator==(const Score&, const Score&) = default;
};

/// State from the last message of a referee.
struct RefereeState {
  GamePhase phase = GamePhase::kNoReferee;
  Restart restart = Restart::kNone;
  bool restart_is_ours = false;
  bool lines_up = false;      // GameSituation::lines_up
  std::uint8_t quadrant = 0;  // of a free ball, as the referee numbers them from 1 on; 0: the referee does not say
  std::uint8_t half = 0;      // of the game, from 1 on; 0: the referee does not say
  // nullopt: the referee does not say, and the former value remains.
  std::optional<bool> own_is_yellow, own_on_positive_half;
  // Height of the robots' markers above the floor; 0: use the height in the team file.
  float own_height_m = 0.0f, opponent_height_m = 0.0f;
  // Whether the referee repeats its messages, so that silence must stop the robots.
  bool repeats = false;
  Instant received{};
  std::optional<Score> score;  // nullopt: the referee does not say

  [[nodiscard]] GameSituation situation() const { return {phase, restart, restart_is_ours, lines_up}; }
};

constexpr Permission permission_in(const RefereeState& state) { return permission_in(state.phase, state.lines_up); }

}  // namespace touchline
