#include "firmware/config/standard_layouts.h"

#include <algorithm>
#include <array>
#include <numbers>

namespace touchline::config {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

MarkerLayout layout_of(float robot_side_m, float height_m, std::initializer_list<PatchPlace> patches) {
  MarkerLayout layout;
  layout.robot_side_m = robot_side_m;
  layout.height_m = height_m;
  for (const PatchPlace& patch : patches) layout.patches.push_back(patch);
  return layout;
}

constexpr PatchPlace team(PatchOutline outline, float x_m, float length_m, float width_m, float turn_rad = 0) {
  return {PatchRole::kTeam, outline, x_m, 0, length_m, width_m, turn_rad};
}

constexpr PatchPlace identification(PatchOutline outline, float x_m, float y_m, float length_m, float width_m,
                                    float turn_rad = 0) {
  return {PatchRole::kIdentification, outline, x_m, y_m, length_m, width_m, turn_rad};
}

// Returns the butterfly of the SSL rules: a dot of 50 mm in the center and four dots of 40 mm, 65 mm from the center.
// The two dots in front are farther apart.
MarkerLayout butterfly() {
  constexpr float kNarrow = 0.035f, kWide = 0.054772f, kDot = 0.04f;
  return layout_of(
      0.18f, 0.15f,
      {team(PatchOutline::kCircle, 0, 0.05f, 0.05f), identification(PatchOutline::kCircle, kNarrow, kWide, kDot, kDot),
       identification(PatchOutline::kCircle, kNarrow, -kWide, kDot, kDot),
       identification(PatchOutline::kCircle, -kWide, kNarrow, kDot, kDot),
       identification(PatchOutline::kCircle, -kWide, -kNarrow, kDot, kDot)});
}

}  // namespace

std::span<const StandardLayout> standard_layouts() {
  using enum PatchOutline;
  static const std::array<StandardLayout, 5> layouts{
      {{"two-squares", "Klancar's: team square in front on the left, identification square behind on the right",
        paper_layout()},
       {"vsss-bar", "team bar over the rear half, two identification squares in front: left, right",
        layout_of(0.075f, 0.06f,
                  {team(kBar, -0.0175f, 0.032f, 0.066f), identification(kSquare, 0.0175f, 0.0163f, 0.031f, 0.031f),
                   identification(kSquare, 0.0175f, -0.0163f, 0.031f, 0.031f)})},
       {"vsss-halves", "team color on the rear half, identification color on the front half",
        layout_of(0.075f, 0.06f,
                  {team(kBar, -0.0185f, 0.037f, 0.074f), identification(kBar, 0.0185f, 0, 0.037f, 0.074f)})},
       {"mirosot-triangles",
        "a square cut along a diagonal: team triangle behind, the other half cut again: left, right; "
        "forward is the corner between these two",
        layout_of(0.075f, 0.075f,
                  {team(kTriangle, -0.0165f, 0.0495f, 0.099f, kPi),
                   identification(kTriangle, 0.0165f, 0.0165f, 0.035f, 0.07f, -0.75f * kPi),
                   identification(kTriangle, 0.0165f, -0.0165f, 0.035f, 0.07f, 0.75f * kPi)})},
       {"ssl-butterfly", "team dot in the center, four dots around it: front left, front right, rear left, rear right",
        butterfly()}}};
  return layouts;
}

const StandardLayout* find_standard_layout(std::string_view name) {
  if (name == "paper") name = "two-squares";
  const auto layouts = standard_layouts();
  const auto found =
      std::find_if(layouts.begin(), layouts.end(), [&](const StandardLayout& layout) { return layout.name == name; });
  return found == layouts.end() ? nullptr : &*found;
}

}  // namespace touchline::config
