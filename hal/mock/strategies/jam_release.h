#pragma once

#include "core/control/strategy.h"
#include "hal/mock/strategies/player_memory.h"

namespace touchline::hal::mock {

/// Frees robots that do not move although they are commanded to, as the published VSSS teams do: a robot at a wall
/// spins, any other drives back.
class JamRelease {
 public:
  void reset() { watched_.clear(); }
  /// Replaces the velocities of jammed robots. Call it once per frame. `radius_m`: half the side of a robot.
  void apply(const Players& players, Instant now, const FieldParameters& field, double radius_m,
             Strategy::Twists& wanted);

 private:
  struct Watched {
    Pose anchor;  // pose at the last detected motion
    Instant since{};
    bool started = false, escaping = false;
    Twist escape;
    float side = 1.0f;  // turning direction; alternates, so the robot does not run into the same jam again
  };
  PlayerMemory<Watched> watched_;
};

}  // namespace touchline::hal::mock
