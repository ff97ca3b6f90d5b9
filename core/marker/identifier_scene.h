#pragma once

#include <cmath>
#include <cstddef>
#include <span>

#include "core/marker/identifier.h"

namespace touchline {

// A margin above this one needs no exact value: the probability of an error is below the rate of other errors.
constexpr float kClearMargin = 5.0f;

struct Identifier::Scene {
  const Frame& frame;
  const ExpectedGain& light;
  const PatchLists& patches;
  std::span<const Hypothesis> hypotheses;
  std::span<const BoxSighting> boxes;
  const Sightings& seen;
  std::size_t team;
  int& borders_left;  // saturated patches whose border may still be looked at in this frame
};

/// Center of a patch of a robot with this pose.
inline FieldPoint on_field(const Pose& pose, const PatchPlace& place) {
  const float c = std::cos(pose.theta_rad), s = std::sin(pose.theta_rad);
  return {pose.position.x_m + c * place.x_m - s * place.y_m, pose.position.y_m + s * place.x_m + c * place.y_m};
}

}  // namespace touchline
