#pragma once

#include <array>

#include "core/track/tracked_robot.h"

namespace touchline {

using RobotSightings = FixedVector<RobotSighting, kMaxRobots>;
using TrackedRobots = FixedVector<TrackedRobot, kMaxRobots>;

/// Assigns sightings to tracks by position. Ids decide only where positions leave a choice:
///  - A sighting near the predicted positions of several tracks of its team belongs to the most likely one. Robots are
///    farther apart than they move in a frame, so a greedy search suffices: the most likely pair comes first. A
///    sighting with another id than the track must be nearer.
///  - A sighting with an id, but near no free track, belongs to the track with this id if that track has no sighting:
///    somebody moved the robot by hand.
class Association {
 public:
  static constexpr std::size_t kNone = kMaxRobots;

  void associate(const RobotSightings& sightings, const TrackedRobots& robots, const TrackParameters& parameters);

  /// Returns the index of the sighting's track, or kNone.
  [[nodiscard]] std::size_t robot_of(std::size_t sighting) const { return robot_of_[sighting]; }
  /// Returns true if only the id connects the sighting with its track.
  [[nodiscard]] bool is_jump(std::size_t sighting) const { return is_jump_[sighting]; }
  /// Returns the id of the sighting; kUnknownId if another sighting has a better claim to this id.
  [[nodiscard]] RobotId id_of(std::size_t sighting) const { return id_of_[sighting]; }
  /// Returns false if no real field can contain the sighting.
  [[nodiscard]] bool is_usable(std::size_t sighting) const { return is_usable_[sighting]; }

 private:
  struct Pair {
    float cost = 0.0f;
    std::uint8_t sighting = 0, robot = 0;
  };

  void collect_pairs(const RobotSightings& sightings, const TrackedRobots& robots, const TrackParameters& parameters);
  void take_pairs();
  void resolve_duplicate_ids(const RobotSightings& sightings, const TrackedRobots& robots);
  void follow_ids(const RobotSightings& sightings, const TrackedRobots& robots, const TrackParameters& parameters);
  [[nodiscard]] bool is_occupied(std::size_t sighting, const RobotSightings& sightings,
                                 const TrackParameters& parameters) const;

  std::array<std::size_t, kMaxRobots> robot_of_{};
  std::array<RobotId, kMaxRobots> id_of_{};
  std::array<bool, kMaxRobots> is_jump_{}, is_usable_{};
  std::array<bool, kMaxRobots> served_{};             // for each robot: whether it has a sighting
  FixedVector<Pair, kMaxRobots * kMaxRobots> pairs_;  // pairs of every sighting with every track
};

}  // namespace touchline
