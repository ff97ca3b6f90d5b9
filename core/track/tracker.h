#pragma once

#include "core/track/command_history.h"
#include "core/track/life_cycle.h"
#include "core/track/outlier_run.h"
#include "core/track/point_filter.h"
#include "core/track/robot_set.h"
#include "core/track/track_parameters.h"
#include "core/types.h"

namespace touchline {

/// One extended Kalman filter a robot, eq. (4)-(9), and one Kalman filter for the ball, eq. (10), (11).
class Tracker {
 public:
  /// kOutOfRange: a parameter outside the range of its declaration that would break a filter.
  Status configure(const TrackParameters& parameters);
  void reset();
  /// Commands that will act on the robots from `acts_at` until the next ones do. Before the first ones (always, in a
  /// replay) own robots are followed like opponents: they keep their velocities, up to noise.
  void commanded(const Commands& commands, Instant acts_at);
  /// Fuses at `capture_time` and predicts to `action_time` (earlier ones count as `capture_time`, later ones than
  /// kMaxPrediction as that); out lists tracks that are not lost, own team first, by id, nameless ones (kUnknownId)
  /// last, by age. A frame that was not captured after the one before it adds nothing: its sightings are ignored. When
  /// time has gone back so far that every track would be lost, everything starts over.
  void update(const Sightings& sightings, Instant capture_time, Instant action_time, Tracks& out);

  /// Nothing here is good for longer: the pipeline's action delay is at most this.
  static constexpr Duration kMaxPrediction = std::chrono::seconds(1);

  /// Sightings for which there was no track left, and commands that had to be forgotten early.
  [[nodiscard]] std::uint64_t dropped() const { return robots_.dropped() + commands_.dropped(); }

 private:
  void update_ball(const BallSighting& sighting, Instant now);
  bool fuse_ball(const BallSighting& sighting, Instant now);
  void report_ball(Instant now, Instant action, BallTrack& out) const;

  TrackParameters parameters_;
  CommandHistory commands_;
  RobotSet robots_;
  PointFilter ball_;
  LifeCycle ball_life_;
  OutlierRun ball_outliers_;
  FieldPoint ball_last_position_;
  bool started_ = false;
  Instant last_time_{};
};

}  // namespace touchline
