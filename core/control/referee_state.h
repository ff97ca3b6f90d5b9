#pragma once

#include <cstdint>
#include <optional>

#include "core/time.h"

namespace touchline {

/// Robots may move in kNoReferee and kRunning only.
enum class GamePhase : std::uint8_t { kNoReferee, kHalt, kStop, kPrepare, kRunning };

constexpr bool may_move_in(GamePhase phase) { return phase == GamePhase::kNoReferee || phase == GamePhase::kRunning; }

/// Goals of both teams.
struct Score {
  std::uint32_t own = 0, opponent = 0;

  friend bool operator==(const Score&, const Score&) = default;
};

/// State from the last message of a referee.
struct RefereeState {
  GamePhase phase = GamePhase::kNoReferee;
  // nullopt: the referee does not say, and the former value remains.
  std::optional<bool> own_is_yellow, own_on_positive_half;
  // Height of the robots' markers above the floor; 0: use the height in the team file.
  float own_height_m = 0.0f, opponent_height_m = 0.0f;
  // Whether the referee repeats its messages, so that silence must stop the robots.
  bool repeats = false;
  Instant received{};
  std::optional<Score> score;  // nullopt: the referee does not say
};

}  // namespace touchline
