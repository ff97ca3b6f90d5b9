#pragma once

#include <array>

#include "core/track/association.h"

namespace touchline {

/// The ids of a team's robots, and the decision which track has which.
class TeamIds {
 public:
  void clear() { ids_.clear(); }
  /// The place of an id in the evidence of the team's tracks. If all places are in use, an id that no track has gives
  /// way. TrackIdentity::kNoSlot: every id is that of a track.
  std::size_t slot_of(RobotId id, Team team, TrackedRobots& robots);
  /// Names the team's robots so that the sum of their log odds is largest and no id occurs twice. A track that lost its
  /// id to another one and is not in `served` ends: its robot is elsewhere.
  /// The work is bounded: one assignment of at most 11 tracks for each of them.
  void assign(Team team, const std::array<bool, kMaxRobots>& served, TrackedRobots& robots);

 private:
  FixedVector<RobotId, kMaxRobotsPerTeam> ids_;
};

}  // namespace touchline
