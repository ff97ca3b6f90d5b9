#pragma once

#include <array>

#include "core/track/association.h"

namespace touchline {

/// The ids of a team's robots, and their assignment to the team's tracks.
class TeamIds {
 public:
  void clear() { ids_.clear(); }
  /// Returns the index of an id in the evidence of the team's tracks. If all indices are in use, the id replaces one
  /// that no track has. TrackIdentity::kNoSlot: all known ids belong to tracks.
  std::size_t slot_of(RobotId id, Team team, TrackedRobots& robots);
  /// Assigns ids to the team's tracks so that the sum of the log-odds is largest and no id occurs twice. A track ends
  /// if it lost its id to another track and is not in `served`, because its robot is elsewhere. The work is bounded,
  /// because a team has at most 11 tracks with evidence.
  void assign(Team team, const std::array<bool, kMaxRobots>& served, TrackedRobots& robots);

  /// See Pipeline::visit_state().
  template <class Self, class Archive>
  static void visit_state(Self& self, Archive& archive) {
    archive(self.ids_);
  }

 private:
  FixedVector<RobotId, kMaxRobotsPerTeam> ids_;
};

}  // namespace touchline
