#pragma once

#include <array>
#include <cstdint>

#include "core/types.h"

namespace touchline {

constexpr int kNoRobot = -1;

/// Log likelihoods of the robots of one team that a frame or a track shows.
struct IdEvidence {
  std::array<float, kMaxRobotsPerTeam> value{};  // log likelihood by index in the list of ids
  float unknown = 0;                             // log likelihood that the robot has none of these ids
};

/// The id of a robot in the best assignment.
struct AssignedId {
  int robot = kNoRobot;  // index in the list of ids; kNoRobot: unknown
  float margin = 0;      // log likelihood that is lost if this robot gets another id
};

using IdEvidences = FixedVector<IdEvidence, kMaxRobotsPerTeam>;
using AssignedIds = FixedVector<AssignedId, kMaxRobotsPerTeam>;

/// Assigns ids to all robots of a team together, so that the sum of log likelihoods is largest and no id occurs twice;
/// any number of robots may stay without an id (Hungarian method with potentials, Kuhn 1955, Munkres 1957). `known`:
/// number of ids. A margin of at least `clear_margin` may be too small, which saves most of the work. `out` has the
/// order of `evidence`.
void assign_ids(const IdEvidences& evidence, std::size_t known, float clear_margin, AssignedIds& out);

}  // namespace touchline
