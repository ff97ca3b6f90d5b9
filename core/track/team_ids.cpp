#include "core/track/team_ids.h"

#include <algorithm>

#include "core/id_assignment.h"

namespace touchline {
namespace {

// Margin of an id, in log-odds, above which it need not be exact: 95 %.
constexpr float kClearMargin = 3.0f;

}  // namespace

std::size_t TeamIds::slot_of(RobotId id, Team team, TrackedRobots& robots) {
  const auto* const found = std::find(ids_.begin(), ids_.end(), id);
  if (found != ids_.end()) return static_cast<std::size_t>(found - ids_.begin());
  if (ids_.push_back(id)) return ids_.size() - 1;
  for (std::size_t slot = 0; slot < ids_.size(); ++slot) {
    const bool in_use = std::any_of(robots.begin(), robots.end(), [&](const TrackedRobot& robot) {
      return robot.team() == team && robot.identity().slot() == slot;
    });
    if (in_use) continue;
    for (TrackedRobot& robot : robots) {
      if (robot.team() == team) robot.identity().forget(slot);
    }
    ids_[slot] = id;
    return slot;
  }
  return TrackIdentity::kNoSlot;
}

void TeamIds::assign(Team team, const std::array<bool, kMaxRobots>& served, TrackedRobots& robots) {
  IdEvidences evidence;
  FixedVector<std::size_t, kMaxRobotsPerTeam> rows;
  for (std::size_t r = 0; r < robots.size(); ++r) {
    if (robots[r].team() != team) continue;
    TrackIdentity& identity = robots[r].identity();
    if (!identity.has_evidence() || !rows.push_back(r)) {
      identity.decide({});
      robots[r].set_id(kUnknownId);
      continue;
    }
    IdEvidence row;
    for (std::size_t slot = 0; slot < ids_.size(); ++slot) row.value[slot] = identity.log_odds(slot);
    evidence.push_back(row);
  }
  AssignedIds assigned;
  assign_ids(evidence, ids_.size(), kClearMargin, assigned);
  std::array<bool, kMaxRobotsPerTeam + 1> taken{};
  for (std::size_t k = 0; k < rows.size(); ++k) {
    TrackIdentity& identity = robots[rows[k]].identity();
    identity.decide(assigned[k]);
    taken[identity.slot()] = true;
  }
  for (std::size_t k = 0; k < rows.size(); ++k) {
    TrackedRobot& robot = robots[rows[k]];
    const std::size_t slot = robot.identity().slot();
    const auto* const former = std::find(ids_.begin(), ids_.end(), robot.id());
    if (slot == TrackIdentity::kNoSlot && former != ids_.end() &&
        taken[static_cast<std::size_t>(former - ids_.begin())] && !served[rows[k]]) {
      robot.lose();
    }
    robot.set_id(slot == TrackIdentity::kNoSlot ? kUnknownId : ids_[slot]);
  }
}

}  // namespace touchline
