#pragma once

#include <array>

#include "core/track/tracked_robot.h"

namespace touchline {

/// The tracks of all robots, and the association of sightings with tracks.
class RobotSet {
 public:
  void clear();
  /// Predicts all tracks from `from` to `now` and then fuses the sightings, in this order:
  ///  - If several sightings have the same id, the one nearest to that track's prediction keeps it (for an id without a
  ///    track: the one that fits its marker best). The others are treated as sightings without id.
  ///  - An id without a track is assigned to an unidentified track at that place, or starts a new track.
  ///  - Sightings without id are associated with the nearest tracks of their team that showed no id in this frame,
  ///    nearest pair first. Robots are farther apart than they move in a frame, so this is the optimal assignment.
  ///  - Remaining sightings start unidentified tracks, unless a robot of their team was seen closer than two robots can
  ///    be.
  void update(const FixedVector<RobotSighting, kMaxRobots>& sightings, Instant from, Instant now,
              const CommandHistory& commands, const TrackParameters& parameters);
  /// Lists the tracks: own team first, by id; unidentified ones last, by age.
  void report(Instant now, Instant action, const CommandHistory& commands, const TrackParameters& parameters,
              FixedVector<RobotTrack, kMaxRobots>& out) const;

  /// Number of sightings that started no track for lack of space.
  [[nodiscard]] std::uint64_t dropped() const { return dropped_; }

 private:
  static constexpr std::size_t kNone = kMaxRobots;
  using Sightings = FixedVector<RobotSighting, kMaxRobots>;

  void predict_all(Instant from, Instant now, const CommandHistory& commands, const TrackParameters& parameters);
  void resolve_duplicate_ids(const Sightings& sightings);
  void associate_by_id(const Sightings& sightings, Instant now, const TrackParameters& parameters);
  void associate_nearest(const Sightings& sightings, Instant now, const TrackParameters& parameters);
  void start_unidentified(const Sightings& sightings, Instant now, const TrackParameters& parameters);
  void remove_duplicates(const TrackParameters& parameters);
  void remove_lost();

  [[nodiscard]] std::size_t find(Team team, RobotId id) const;
  [[nodiscard]] std::size_t nearest_unidentified(const RobotSighting& sighting,
                                                 const TrackParameters& parameters) const;
  void fuse(std::size_t robot, const RobotSighting& sighting, Instant now, const TrackParameters& parameters);
  void begin(const RobotSighting& sighting, Instant now, const TrackParameters& parameters);

  FixedVector<TrackedRobot, kMaxRobots> robots_;
  std::array<bool, kMaxRobots> served_{};       // by robot: has a sighting in this frame, accepted or not
  std::array<bool, kMaxRobots> fused_{};        // by robot: the sighting was accepted
  std::array<RobotId, kMaxRobots> shown_id_{};  // by sighting: id after duplicates were resolved
  std::array<bool, kMaxRobots> used_{};         // by sighting: associated or unusable
  std::uint32_t births_ = 0;
  std::uint64_t dropped_ = 0;
};

}  // namespace touchline
