#pragma once

#include "core/geometry/vector2.h"
#include "core/types.h"
#include "tools/programs/simulate/release_0_1/parameters.h"

namespace touchline::release_0_1 {

/// Detects a robot that does not move although it is commanded to (a wall, another robot, a ball jammed between them),
/// and drives it backward for a while.
class StuckMonitor {
 public:
  /// Call once per frame with the desired velocities. Returns the desired velocities, or the velocities of the escape.
  Twist watch(const Pose& robot, const Twist& wanted, Instant now, const PlayParameters& play);
  [[nodiscard]] bool escaping() const { return escaping_; }

 private:
  void restart(const Pose& robot, Instant now);

  bool started_ = false, escaping_ = false;
  Pose anchor_;  // pose at the last detected motion
  Instant since_{};
  double wanted_ = 0.0;  // last desired speed, with sign
  double turn_ = 1.0;    // turning direction; alternates, so the robot does not run into the same jam again
};

}  // namespace touchline::release_0_1
