#pragma once

#include <array>

#include "core/control/pitch.h"
#include "core/geometry/vector2.h"

namespace touchline {

struct BallState {
  Vector2 position, velocity;
};

/// One step of a rolling ball that loses dv/dt = deceleration + damping * v. The step is so short that the ball meets
/// each wall once at most. Walls reflect it; in a goal's mouth it rolls on into the goal.
BallState rolled(BallState ball, double step_s, const Pitch& pitch);

/// How a ball rolls that nobody touches.
class BallPath {
 public:
  static constexpr double kStepS = 0.05;
  static constexpr std::size_t kSteps = 41;  // 2 s

  BallPath() = default;
  BallPath(BallState ball, const Pitch& pitch);
  /// Ball after `time_s` (interpolated); after the horizon, the last one.
  [[nodiscard]] BallState at(double time_s) const;

 private:
  std::array<BallState, kSteps> states_{};
};

}  // namespace touchline
