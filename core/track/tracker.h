#pragma once

#include <type_traits>

#include "core/track/command_history.h"
#include "core/track/robot_set.h"
#include "core/track/track_parameters.h"
#include "core/track/tracked_ball.h"
#include "core/types.h"

namespace touchline {

/// Tracks all robots, each with an extended Kalman filter, eq. (4)-(9), and the ball with a Kalman filter, eq. (10),
/// (11).
class Tracker {
 public:
  /// kOutOfRange: a parameter that would break a filter.
  Status configure(const TrackParameters& parameters);
  void reset();
  /// Adds commands that act on the robots from `acts_at` until the next ones act. Before the first commands (in a
  /// replay always), own robots are tracked like opponents: with constant velocities except for noise.
  void add_commands(const Commands& commands, Instant acts_at);
  /// Sets how much later than `acts_at` and `action_time` the own robot `id` gets its commands.
  void set_lateness(RobotId id, Duration lateness) { commands_.set_lateness(id, lateness); }
  /// Replaces tracking.robot.wheel_lag_s; tracks continue.
  void set_wheel_lag(double lag_s) { parameters_.robot.wheel_lag_s = lag_s; }
  /// Fuses the sightings at `capture_time` and predicts to `action_time`, which is limited to the interval from
  /// `capture_time` to kMaxPrediction later. `out` lists the tracks that are not lost: own team first, by id;
  /// unidentified ones (kUnknownId) last, by age. The sightings of a frame that was not captured after the previous one
  /// are ignored. If time jumps back so far that every track would be lost, the tracker is reset.
  void update(const Sightings& sightings, Instant capture_time, Instant action_time, Tracks& out);

  /// Returns the ball's expected position in the next frame; unknown if the ball was not seen for long.
  [[nodiscard]] ExpectedBall expected_ball(Instant capture_time) const;
  /// Lists where the robots with an id and a heading should be at a capture time after the last one, except those that
  /// are lost by then. Empty before the first frame.
  void expected_robots(Instant capture_time, ExpectedRobots& out) const;

  /// Longest useful prediction. The pipeline's action delay is at most this long.
  static constexpr Duration kMaxPrediction = std::chrono::seconds(1);

  /// Returns the commanded twist that acts on an own robot at `instant`, which is not before the last update; zero if
  /// unknown.
  [[nodiscard]] Twist command_at(Instant instant, RobotId id) const { return commands_.at(instant, id).twist; }

  /// Returns the number of sightings without a free track, and of commands that were removed too early for lack of
  /// space.
  [[nodiscard]] std::uint64_t dropped() const { return robots_.dropped() + commands_.dropped(); }

  /// See Pipeline::visit_state().
  template <class Self, class Archive>
  static void visit_state(Self& self, Archive& archive) {
    auto& [parameters, commands, robots, ball, started, last_time] = self;
    archive(commands, robots, ball, started, last_time);
    if constexpr (!std::is_const_v<Self>) {
      // Otherwise the next prediction could cover years, in steps of milliseconds.
      if (robots.last_seen() > last_time) archive.refuse();
    }
  }

 private:
  TrackParameters parameters_;
  CommandHistory commands_;
  RobotSet robots_;
  TrackedBall ball_;
  bool started_ = false;
  Instant last_time_{};
};

}  // namespace touchline
