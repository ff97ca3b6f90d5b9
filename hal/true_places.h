#pragma once

#include "core/fixed_vector.h"
#include "core/types.h"

namespace touchline::hal {

/// Where robots and ball truly were at a frame's capture time. Only an arena knows it. It is for people who compare it
/// with what was recognized; nothing is decided by it.
struct TruePlaces {
  struct Robot {
    Team team = Team::kOwn;
    RobotId id = kUnknownId;
    Pose pose;
  };
  bool is_known = false;
  FieldPoint ball;
  FixedVector<Robot, kMaxRobots> robots;
};

}  // namespace touchline::hal
