#pragma once

#include <cstdint>

#include "core/track/activity.h"
#include "core/track/command_history.h"
#include "core/track/consecutive_outliers.h"
#include "core/track/life_cycle.h"
#include "core/track/point_filter.h"
#include "core/track/robot_motion.h"
#include "core/track/track_identity.h"

namespace touchline {

/// The track of one robot from its first sighting until it is lost. Before the first sighting with a heading, the
/// motion model is a point with constant velocity; afterwards it is a differential drive, free or in contact.
class TrackedRobot {
 public:
  void start(const RobotSighting& sighting, Instant now, std::uint32_t birth, const TrackParameters& parameters);

  /// Predicts from `from` to `to` with the commands that act in this time. `commands`: null if they are unknown.
  void predict(Instant from, Instant to, const CommandHistory* commands, const TrackParameters& parameters);
  /// Like predict(), but only for pose() and twist().
  void look_ahead(Instant from, Instant to, const CommandHistory* commands, const TrackParameters& parameters);
  /// Gates the sighting, then updates or resets the filter. Returns false if the sighting was rejected.
  bool fuse(const RobotSighting& sighting, Instant now, const TrackParameters& parameters);
  void missed(Instant now, const TrackParameters& parameters);
  void lose() { life_.lose(); }
  /// Moves the track without a sighting.
  void shift_to(FieldPoint position);
  TrackIdentity& identity() { return identity_; }
  [[nodiscard]] const TrackIdentity& identity() const { return identity_; }
  /// Sets the id that TeamIds has assigned.
  void set_id(RobotId id) { id_ = id; }

  [[nodiscard]] Team team() const { return team_; }
  [[nodiscard]] RobotId id() const { return id_; }
  [[nodiscard]] bool heading_known() const { return heading_known_; }
  [[nodiscard]] std::uint32_t birth() const { return birth_; }
  [[nodiscard]] const LifeCycle& life() const { return life_; }
  [[nodiscard]] FieldPoint position() const;
  /// Returns the larger of the standard deviations of x and y.
  [[nodiscard]] double position_sigma_m() const;
  /// Fills all fields except those at the time of the action.
  [[nodiscard]] RobotTrack report(const TrackParameters& parameters) const;
  [[nodiscard]] Pose pose() const;
  [[nodiscard]] Twist twist() const;
  /// Returns false if the filter is broken, which only the state of a damaged recording can do (visit_state()).
  [[nodiscard]] bool is_finite() const;

  /// See Pipeline::visit_state().
  template <class Self, class Archive>
  static void visit_state(Self& self, Archive& archive) {
    auto& [team, id, birth, heading_known, commands_known, drive, point, life, outliers, last_position, confidence,
           innovation2, surprise, drive_activity, turn_activity, identity] = self;
    archive(team, id, birth, heading_known, commands_known, drive, point, life, outliers, last_position, confidence,
            innovation2, surprise, drive_activity, turn_activity, identity);
  }

 private:
  /// Returns `commands` if they are certainly meant for this robot, else null.
  [[nodiscard]] const CommandHistory* own_commands(const CommandHistory* commands) const;
  template <class Predict>
  void follow_commands(Instant from, Instant to, const CommandHistory* commands, Predict predict);
  void start_drive(const RobotSighting& sighting, const DriveFilter::Velocity& velocity,
                   const RobotFilterParameters& parameters);
  bool fuse_pose(const RobotSighting& sighting, Instant now, const RobotFilterParameters& parameters);
  bool fuse_without_heading(const RobotSighting& sighting, const RobotFilterParameters& parameters);
  void restart(const RobotSighting& sighting, Instant now, const TrackParameters& parameters);

  Team team_ = Team::kOwn;
  RobotId id_ = kUnknownId;
  std::uint32_t birth_ = 0;  // order of birth, which distinguishes tracks without id
  bool heading_known_ = false;
  bool commands_known_ = false;  // whether commands were known in the last prediction with a heading
  RobotMotion drive_;
  PointFilter point_;
  LifeCycle life_;
  ConsecutiveOutliers outliers_;
  FieldPoint last_position_;                     // position at the last sighting
  float confidence_ = 0.0f;                      // confidence of the last sighting
  float innovation2_ = -1.0f;                    // as in RobotTrack
  double surprise_ = 0.0;                        // mean of the last squared innovations per degree of freedom
  FreeActivity drive_activity_, turn_activity_;  // activities of the linear and of the angular velocity
  TrackIdentity identity_;
};

}  // namespace touchline
