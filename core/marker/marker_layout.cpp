#include "core/marker/marker_layout.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/parameter.h"

namespace touchline {
namespace {

// Returns false for NaN.
bool within(float value, float bound) { return std::abs(value) <= bound; }

bool same_colors(const RobotMarking& a, const RobotMarking& b) {
  return std::equal(a.colors.begin(), a.colors.end(), b.colors.begin(), b.colors.end());
}

Status validate(const RobotMarking& robot, std::size_t identification_patches, ColorId team_color) {
  if (robot.id < 0) return ErrorCode::kOutOfRange;
  if (robot.colors.size() != identification_patches) return ErrorCode::kInconsistent;
  for (const ColorId color : robot.colors) {
    if (color == kBackground || color > kMaxColors) return ErrorCode::kOutOfRange;
    if (color == team_color) return ErrorCode::kInconsistent;
  }
  return {};
}

}  // namespace

MarkerLayout paper_layout() {
  // Figure 2: quadrants of 37.5 mm. The patches are smaller, so neighboring ones do not touch.
  constexpr float kQuarter = 0.01875f, kPatch = 0.0345f;
  MarkerLayout layout;
  layout.patches.push_back({PatchRole::kTeam, PatchOutline::kSquare, kQuarter, kQuarter, kPatch, kPatch});
  layout.patches.push_back({PatchRole::kIdentification, PatchOutline::kSquare, -kQuarter, -kQuarter, kPatch, kPatch});
  return layout;
}

Status validate(const MarkerLayout& layout) {
  if (layout.patches.empty() || !is_positive(layout.robot_side_m)) return ErrorCode::kOutOfRange;
  if (!std::isfinite(layout.height_m) || layout.height_m < 0.0f) return ErrorCode::kOutOfRange;
  for (std::size_t i = 0; i < layout.patches.size(); ++i) {
    const PatchPlace& place = layout.patches[i];
    if ((place.role == PatchRole::kTeam) != (i == 0)) return ErrorCode::kInconsistent;
    if (!is_positive(place.length_m) || !is_positive(place.width_m)) return ErrorCode::kOutOfRange;
    if (!std::isfinite(place.turn_rad)) return ErrorCode::kOutOfRange;
    if (!within(place.x_m, layout.robot_side_m / 2) || !within(place.y_m, layout.robot_side_m / 2)) {
      return ErrorCode::kOutOfRange;
    }
  }
  return {};
}

Status validate(const TeamMarking& team) {
  if (team.team_color == kBackground) return {};
  if (Status s = validate(team.layout); !s.ok()) return s;
  if (team.team_color > kMaxColors || team.max_robots > kMaxRobotsPerTeam) return ErrorCode::kOutOfRange;
  for (std::size_t i = 0; i < team.robots.size(); ++i) {
    if (Status s = validate(team.robots[i], team.layout.patches.size() - 1, team.team_color); !s.ok()) return s;
    for (std::size_t j = 0; j < i; ++j) {
      if (team.robots[i].id == team.robots[j].id) return ErrorCode::kInconsistent;
      if (same_colors(team.robots[i], team.robots[j])) return ErrorCode::kInconsistent;
    }
  }
  return {};
}

float area_m2(const PatchPlace& place) {
  const float rectangle = place.length_m * place.width_m;
  switch (place.outline) {
    case PatchOutline::kSquare:
    case PatchOutline::kBar:
      return rectangle;
    case PatchOutline::kTriangle:
      return 0.5f * rectangle;
    case PatchOutline::kCircle:
      return 0.25f * std::numbers::pi_v<float> * rectangle;
  }
  return rectangle;
}

PrincipalVariances principal_variances(const PatchPlace& place) {
  float along = place.length_m * place.length_m, across = place.width_m * place.width_m;
  switch (place.outline) {
    case PatchOutline::kSquare:
    case PatchOutline::kBar:
      along /= 12.0f;
      across /= 12.0f;
      break;
    case PatchOutline::kTriangle:  // isosceles
      along /= 18.0f;
      across /= 24.0f;
      break;
    case PatchOutline::kCircle:
      along /= 16.0f;
      across /= 16.0f;
      break;
  }
  if (along >= across) return {along, across, place.turn_rad};
  return {across, along, place.turn_rad + 0.5f * std::numbers::pi_v<float>};
}

}  // namespace touchline
