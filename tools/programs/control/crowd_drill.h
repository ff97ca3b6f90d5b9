#pragma once

#include <cstdint>

#include "tools/programs/control/drill.h"

namespace touchline::control_evaluation {

struct CrowdSettings {
  int own = 5, opponents = 5;
  double duration_s = 120.0;
  double max_speed_mps = 0.0;  // 0: as in the team file
  bool strict = false;
};

struct CrowdResult {
  double goals_per_minute = 0.0;        // of a robot, mean
  double least_goals_per_minute = 0.0;  // of the slowest robot
  // Contacts between robots of one side and between the sides, each per robot and minute.
  double own_contacts = 0.0, mixed_contacts = 0.0;
  double longest_s = 0.0;  // longest time that a robot needed to reach a goal
};

/// Lets all robots drive to random places; a robot that arrives gets the next one.
Result<CrowdResult> crowd_drill(const config::Configuration& configuration, const CrowdSettings& settings,
                                std::uint64_t seed);

}  // namespace touchline::control_evaluation
