#pragma once

#include <array>

#include "core/control/pitch.h"
#include "core/geometry/vector2.h"

namespace touchline {

struct BallState {
  Vector2 position, velocity;
};

/// One step of a rolling ball. The step is so short that the ball meets each wall once at most.
class Rolling {
 public:
  explicit Rolling(double step_s);
  [[nodiscard]] BallState after(BallState ball, const Pitch& pitch) const;

 private:
  double decay_, way_s_;
};

/// How a ball rolls that nobody touches: its speed decays exponentially, and walls reflect it. In a goal's mouth it
/// rolls on into the goal.
class BallPath {
 public:
  static constexpr double kStepS = 0.05, kHorizonS = 2.0;
  static constexpr std::size_t kSteps = 41;

  BallPath() = default;
  BallPath(BallState ball, const Pitch& pitch);
  /// Ball after `time_s` (interpolated); after the horizon, the last one.
  [[nodiscard]] BallState at(double time_s) const;

 private:
  std::array<BallState, kSteps> states_{};
};

}  // namespace touchline
