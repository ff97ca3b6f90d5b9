#pragma once

#include <algorithm>
#include <array>

#include "core/track/association.h"
#include "core/track/team_ids.h"
#include "core/track/tracked_robot.h"

namespace touchline {

/// The tracks of all robots, and their sightings.
class RobotSet {
 public:
  void clear();
  /// Predicts all tracks from `from` to `now` and then fuses the sightings, in this order:
  ///  - Sightings are associated with tracks (association.h), and add evidence for their ids (track_identity.h).
  ///  - Remaining sightings start tracks, unless a robot of their team was seen closer than two robots can be.
  ///  - Ids are assigned to all tracks of a team together (team_ids.h).
  ///  - Two tracks of a team never share a sighting or a position: a track without a sighting gives way.
  void update(const FixedVector<RobotSighting, kMaxRobots>& sightings, Instant from, Instant now,
              const CommandHistory& commands, const TrackParameters& parameters);
  /// Adds the robots with an id and a heading, where they should be at `then`, unless they will be lost by then.
  void expect(Instant now, Instant then, const CommandHistory& commands, const TrackParameters& parameters,
              ExpectedRobots& out) const;
  /// Lists the tracks: own team first, by id; unidentified ones last, by age.
  void report(Instant now, Instant action, const CommandHistory& commands, const TrackParameters& parameters,
              FixedVector<RobotTrack, kMaxRobots>& out) const;

  /// Returns the number of sightings that started no track for lack of space.
  [[nodiscard]] std::uint64_t dropped() const { return dropped_; }

  /// See Pipeline::visit_state(). The rest is that of one frame.
  template <class Self, class Archive>
  static void visit_state(Self& self, Archive& archive) {
    auto& [robots, ids, association, served, fused, births, dropped] = self;
    archive(robots, ids, births);
  }
  /// Returns when a robot was last seen, at the latest.
  [[nodiscard]] Instant last_seen() const {
    Instant last = Instant::min();
    for (const TrackedRobot& robot : robots_) last = std::max(last, robot.life().last_seen());
    return last;
  }

 private:
  static constexpr std::size_t kNone = kMaxRobots;
  using Sightings = RobotSightings;

  void predict_all(Instant from, Instant now, const CommandHistory& commands, const TrackParameters& parameters);
  void fuse_associated(const Sightings& sightings, Instant now, const TrackParameters& parameters);
  void start_remaining(const Sightings& sightings, Instant now, const TrackParameters& parameters);
  void add_evidence(std::size_t robot, RobotId id, float confidence, Instant now);
  void separate(const TrackParameters& parameters);
  bool gives_way(std::size_t robot, std::size_t other) const;
  void remove_lost();
  std::size_t begin(const RobotSighting& sighting, Instant now, const TrackParameters& parameters);

  TrackedRobots robots_;
  std::array<TeamIds, 2> ids_;  // indexed by Team
  Association association_;
  // For each robot: whether the robot has a sighting in this frame, accepted or not.
  std::array<bool, kMaxRobots> served_{};
  std::array<bool, kMaxRobots> fused_{};  // for each robot: whether its sighting was accepted
  std::uint32_t births_ = 0;
  std::uint64_t dropped_ = 0;
};

}  // namespace touchline
