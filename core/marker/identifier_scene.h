#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <span>

#include "core/marker/identifier.h"

namespace touchline {

// A margin above this one needs no exact value: the probability of an error is below the rate of other errors.
constexpr float kClearMargin = 5.0f;

// The colors of a team's paints in one robot's light.
struct Identifier::ExpectedColors {
  const LocalLight* light = nullptr;  // null: none is known
  std::array<bool, kMaxColors + 1> is_known{};
  std::array<ExpectedColor, kMaxColors + 1> color;
};

struct Identifier::Scene {
  const Frame& frame;
  const ExpectedGain& light;
  const PatchLists& patches;
  std::span<const Hypothesis> hypotheses;
  std::span<const BoxSighting> boxes;
  const Sightings& seen;
  std::size_t team;
  int& borders_left;  // saturated patches whose border may still be looked at in this frame
  const ColorEvidence& colors;
  ExpectedColors& expected;
  int saturated_from = kSaturatedValue;

  /// As sample_surface().
  [[nodiscard]] bool sample(PixelPoint center, int step_px, SurfaceColor& out) const {
    return sample_surface(frame, center, step_px, out, saturated_from);
  }

  /// `on_robot`: a candidate's light. Looking at its team patch forgets the colors.
  [[nodiscard]] const ExpectedColor& expected_color(const LocalLight& on_robot, ColorId color) const {
    if (expected.light != &on_robot) {
      expected.light = &on_robot;
      expected.is_known.fill(false);
    }
    if (!expected.is_known[color]) {
      expected.color[color] = colors.expected_color(on_robot, color, color_space(frame.format));
      expected.is_known[color] = true;
    }
    return expected.color[color];
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
