#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <span>

#include "core/marker/identifier.h"

namespace touchline {

// Larger margins need no exact value: a wrong id is then less likely than other errors.
constexpr float kClearMargin = 5.0f;

// A slot's colors and the team color in one robot's light, four at a time.
struct Identifier::ExpectedColors {
  const LocalLight* light = nullptr;  // null: no light has been set
  std::array<bool, kMaxPatches - 1> is_known{};
  std::array<std::array<ExpectedColors4, kColorGroups>, kMaxPatches - 1> of_slot;
};

struct Identifier::Scene {
  const Frame& frame;
  const ExpectedGain& light;
  const PatchLists& patches;
  std::span<const Hypothesis> hypotheses;
  std::span<const BoxSighting> boxes;
  const Sightings& seen;
  std::size_t team;
  int& borders_left;  // borders of saturated patches that may still be examined: the share of the robot, or of the
                      // robots, that are examined now
  ExpectedColors& expected;
  int saturated_from = kSaturatedValue;

  /// Samples as sample_surface() does.
  [[nodiscard]] bool sample(PixelPoint center, int step_px, SurfaceColor& out) const {
    return sample_surface(frame, center, step_px, out, saturated_from);
  }
};

/// Finds the centers of a robot's patches on the field.
class RobotOnField {
 public:
  explicit RobotOnField(const Pose& pose)
      : origin_(pose.position), c_(std::cos(pose.theta_rad)), s_(std::sin(pose.theta_rad)) {}
  FieldPoint operator()(const PatchPlace& place) const {
    return {origin_.x_m + c_ * place.x_m - s_ * place.y_m, origin_.y_m + s_ * place.x_m + c_ * place.y_m};
  }

 private:
  FieldPoint origin_;
  float c_, s_;
};
inline FieldPoint on_field(const Pose& pose, const PatchPlace& place) { return RobotOnField(pose)(place); }

}  // namespace touchline
