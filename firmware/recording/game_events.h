#pragma once

#include <array>
#include <bitset>
#include <cstdint>
#include <limits>
#include <optional>

#include "core/control/referee_state.h"
#include "core/fixed_vector.h"
#include "core/types.h"
#include "firmware/recording/goal_rule.h"
#include "firmware/report/json_writer.h"
#include "firmware/snapshot.h"

namespace touchline::recording {

/// A moment of a game to which a viewer jumps.
struct GameEvent {
  enum class Kind : std::uint8_t {
    kScore,      // the score at the beginning, or one that was corrected
    kGoal,       // with the score after it
    kStop,       // robots have to stand
    kStart,      // robots may move again
    kRobotLost,  // an own robot has no track any more
    kSlowest     // the longest latency so far
  };
  Kind kind = Kind::kScore;
  Team team = Team::kOwn;   // that has scored
  bool by_referee = false;  // false: GoalRule has counted
  Score score{};
  std::uint32_t halt = 0;  // bits of Halt
  RobotId id = kUnknownId;
  Duration latency{};
};

/// One event of each kind, but all own robots may be lost in the same frame.
using FrameEvents = FixedVector<GameEvent, kMaxRobotsPerTeam + 4>;

/// Finds the events of a session.
class GameEvents {
 public:
  GameEvents(const FieldParameters& field, float ball_radius_m) : rule_(field, ball_radius_m) {}

  /// Returns the events of a frame.
  [[nodiscard]] FrameEvents add(const Snapshot& snapshot);
  /// Returns the events of a stop without a frame. `halt` has bits of Halt.
  [[nodiscard]] FrameEvents add_stop(std::uint32_t halt);

 private:
  void add_score(const Snapshot& snapshot, FrameEvents& out);
  void add_halt(std::uint32_t halt, FrameEvents& out);
  void add_lost(const Tracks& tracks, FrameEvents& out);

  GoalRule rule_;
  std::optional<Score> score_;
  Score counted_{};                    // by the rule
  std::optional<std::uint32_t> halt_;  // nullopt: at the beginning
  std::bitset<std::numeric_limits<RobotId>::max() + 1> tracked_;
  Duration slowest_{};
};

/// Writes {"kind":"goal","team":"own","by":"referee","own":1,"opponent":0}; "stop" has "halt", "robot_lost" has "id",
/// "slowest" has "latency_ms".
void write_event(report::JsonWriter& json, const GameEvent& event);

}  // namespace touchline::recording
