#pragma once

#include <array>

#include "core/track/tracked_robot.h"

namespace touchline {

/// All robots that are followed, and which of them each sighting of a frame belongs to.
class RobotSet {
 public:
  void clear();
  /// Predicts all from `from` to `now`, then gives each its sighting. Rules, in this order:
  ///  - Of several sightings with the same id the one nearest to that robot's prediction counts (of a robot not yet
  ///    followed: the one that fits its marker best); the others count as sightings without id.
  ///  - An id that is not yet followed names a nameless track that stands there, or begins one.
  ///  - Sightings without id belong to the nearest robots of their team that showed no id in this frame, nearest pair
  ///    first (robots are farther apart than they go in a frame, so this is the best assignment).
  ///  - Those left over begin nameless tracks, unless a robot of their team was seen nearer than two can stand.
  void update(const FixedVector<RobotSighting, kMaxRobots>& sightings, Instant from, Instant now,
              const CommandHistory& commands, const TrackParameters& parameters);
  /// Sorted: own team first, by id, nameless ones last, by age.
  void report(Instant now, Instant action, const CommandHistory& commands, const TrackParameters& parameters,
              FixedVector<RobotTrack, kMaxRobots>& out) const;

  /// Sightings for which there was no room.
  [[nodiscard]] std::uint64_t dropped() const { return dropped_; }

 private:
  static constexpr std::size_t kNone = kMaxRobots;
  using Sightings = FixedVector<RobotSighting, kMaxRobots>;

  void predict_all(Instant from, Instant now, const CommandHistory& commands, const TrackParameters& parameters);
  void settle_ids(const Sightings& sightings);
  void give_known_ids(const Sightings& sightings, Instant now, const TrackParameters& parameters);
  void give_nearest(const Sightings& sightings, Instant now, const TrackParameters& parameters);
  void begin_nameless(const Sightings& sightings, Instant now, const TrackParameters& parameters);
  void drop_doubles(const TrackParameters& parameters);
  void remove_lost();

  [[nodiscard]] std::size_t find(Team team, RobotId id) const;
  [[nodiscard]] std::size_t nearest_nameless(const RobotSighting& sighting, const TrackParameters& parameters) const;
  void fuse(std::size_t robot, const RobotSighting& sighting, Instant now, const TrackParameters& parameters);
  void begin(const RobotSighting& sighting, Instant now, const TrackParameters& parameters);

  FixedVector<TrackedRobot, kMaxRobots> robots_;
  std::array<bool, kMaxRobots> served_{};       // robots: got a sighting in this frame, refused or not
  std::array<bool, kMaxRobots> fused_{};        // robots: and took it
  std::array<RobotId, kMaxRobots> shown_id_{};  // sightings: id after doubles were settled
  std::array<bool, kMaxRobots> used_{};         // sightings: given to a robot, or no use
  std::uint32_t births_ = 0;
  std::uint64_t dropped_ = 0;
};

}  // namespace touchline
