#include "firmware/config/layout_choice.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "firmware/config/standard_layouts.h"

namespace touchline::config {
namespace {

struct Disk {
  float x_m, y_m, radius_m;
};

// Returns the patch as a circle, or the corners of another outline, in the robot's axes.
std::vector<Disk> corners_of(const PatchPlace& patch) {
  if (patch.outline == PatchOutline::kCircle) return {{patch.x_m, patch.y_m, patch.length_m / 2}};
  const float l = patch.length_m / 2, w = patch.width_m / 2;
  std::vector<Disk> corners = {{l, w, 0}, {l, -w, 0}, {-l, -w, 0}, {-l, w, 0}};
  // The centroid is a third of the height above the base.
  if (patch.outline == PatchOutline::kTriangle) corners = {{4 * l / 3, 0, 0}, {-2 * l / 3, w, 0}, {-2 * l / 3, -w, 0}};
  const float c = std::cos(patch.turn_rad), s = std::sin(patch.turn_rad);
  for (Disk& corner : corners) {
    corner = {patch.x_m + c * corner.x_m - s * corner.y_m, patch.y_m + s * corner.x_m + c * corner.y_m, 0};
  }
  return corners;
}

}  // namespace

MarkerLayout layout_of(const LayoutEntry& entry) {
  MarkerLayout out;
  out.robot_side_m = entry.robot_side_m;
  out.height_m = entry.height_m;
  out.patches.clear();
  for (const PatchEntry& patch : entry.patch) {
    out.patches.push_back(
        {patch.role, patch.outline, patch.x_m, patch.y_m, patch.length_m, patch.width_m, patch.turn_rad});
  }
  return out;
}

std::optional<MarkerLayout> chosen_layout(const TeamFile& file, const TeamEntry& team) {
  std::optional<MarkerLayout> out;
  const auto own = std::find_if(file.layout.begin(), file.layout.end(),
                                [&](const LayoutEntry& entry) { return entry.name == team.layout; });
  if (own != file.layout.end()) {
    out = layout_of(*own);
  } else if (const StandardLayout* standard = find_standard_layout(team.layout)) {
    out = standard->layout;
  }
  if (out && team.height_m >= 0) out->height_m = team.height_m;
  return out;
}

float body_turn_rad(const MarkerLayout& layout) {
  constexpr int kSteps = 90;  // steps of one degree
  const auto half_side = [&](float turn_rad) {
    const float c = std::cos(turn_rad), s = std::sin(turn_rad);
    float most = 0;
    for (const PatchPlace& patch : layout.patches) {
      for (const Disk& at : corners_of(patch)) {
        most = std::max(
            {most, std::abs(c * at.x_m + s * at.y_m) + at.radius_m, std::abs(c * at.y_m - s * at.x_m) + at.radius_m});
      }
    }
    return most;
  };
  float best_rad = 0, least = half_side(0);
  if (least <= layout.robot_side_m / 2) return 0;
  for (int i = 1; i < kSteps; ++i) {
    const float turn_rad = static_cast<float>(i) * std::numbers::pi_v<float> / (2 * kSteps), half = half_side(turn_rad);
    if (half >= least) continue;
    least = half;
    best_rad = turn_rad;
  }
  return best_rad;
}

}  // namespace touchline::config
