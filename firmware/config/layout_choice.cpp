#include "firmware/config/layout_choice.h"

#include <algorithm>

#include "firmware/config/standard_layouts.h"

namespace touchline::config {

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

}  // namespace touchline::config
