#pragma once

#include "core/fixed_vector.h"
#include "core/types.h"

namespace touchline {

/// An own robot that takes part in the game, predicted to the time at which its command acts.
struct Player {
  RobotId id = kUnknownId;
  Pose pose;
  Twist twist;
  Twist wheels{};  // velocities of the wheels by the commands alone
};
using Players = FixedVector<Player, kMaxRobotsPerTeam>;

}  // namespace touchline
