#pragma once

#include "core/control/control_parameters.h"
#include "core/geometry/vector2.h"
#include "core/types.h"

namespace touchline {

/// Notices that a robot does not move although it is told to (a wall, another robot, the ball jammed between them)
/// and backs it off for a while.
class StuckMonitor {
 public:
  /// To be asked every frame with what the play wants; returns that, or the way out.
  Twist watch(const Pose& robot, const Twist& wanted, Instant now, const PlayParameters& play);
  [[nodiscard]] bool escaping() const { return escaping_; }

 private:
  void restart(const Pose& robot, Instant now);

  bool started_ = false, escaping_ = false;
  Pose anchor_;  // where it was when it last had moved
  Instant since_{};
  double wanted_ = 0.0;  // speed it was told to go last, with sign
  double turn_ = 1.0;    // alternates, so that the same jam is not run into again
};

}  // namespace touchline
