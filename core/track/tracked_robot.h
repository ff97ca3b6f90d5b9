#pragma once

#include <cstdint>

#include "core/track/command_history.h"
#include "core/track/drive_filter.h"
#include "core/track/life_cycle.h"
#include "core/track/outlier_run.h"
#include "core/track/point_filter.h"

namespace touchline {

/// One robot from its first sighting to its loss. As long as no sighting has shown its heading it is a point that
/// moves on; from the first heading on it is a differential drive.
class TrackedRobot {
 public:
  void start(const RobotSighting& sighting, Instant now, std::uint32_t birth, const TrackParameters& parameters);

  /// From `from` to `to` under the commands that act between; null: they are not known.
  void predict(Instant from, Instant to, const CommandHistory* commands, const TrackParameters& parameters);
  /// The same for pose() and twist() alone.
  void look_ahead(Instant from, Instant to, const CommandHistory* commands, const TrackParameters& parameters);
  /// Gate, correction, or start-over. False: the sighting was refused.
  bool fuse(const RobotSighting& sighting, Instant now, const TrackParameters& parameters);
  void missed(Instant now, const TrackParameters& parameters);
  void lose() { life_.lose(); }
  /// A robot without id has shown one.
  void name(RobotId id) { id_ = id; }

  [[nodiscard]] Team team() const { return team_; }
  [[nodiscard]] RobotId id() const { return id_; }
  [[nodiscard]] std::uint32_t birth() const { return birth_; }
  [[nodiscard]] const LifeCycle& life() const { return life_; }
  [[nodiscard]] FieldPoint position() const;
  /// Larger one of the two axes.
  [[nodiscard]] double position_sigma_m() const;
  /// All but the fields about the action.
  [[nodiscard]] RobotTrack report(const TrackParameters& parameters) const;
  [[nodiscard]] Pose pose() const;
  [[nodiscard]] Twist twist() const;

 private:
  template <class Predict>
  void follow_commands(Instant from, Instant to, const CommandHistory* commands, Predict predict);
  void restart(const RobotSighting& sighting, Instant now, const TrackParameters& parameters);

  Team team_ = Team::kOwn;
  RobotId id_ = kUnknownId;
  std::uint32_t birth_ = 0;  // tells tracks without id apart
  bool heading_known_ = false;
  DriveFilter drive_;
  PointFilter point_;
  LifeCycle life_;
  OutlierRun outliers_;
  FieldPoint last_position_;  // when last seen
};

}  // namespace touchline
