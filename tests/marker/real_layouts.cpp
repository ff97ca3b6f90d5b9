#include "tests/marker/real_layouts.h"

#include <numbers>

namespace touchline::testing {
namespace {

constexpr PatchRole kTeamPatch = PatchRole::kTeam, kIdentification = PatchRole::kIdentification;

MarkerLayout layout_of(std::initializer_list<PatchPlace> patches, float side_m, float height_m) {
  MarkerLayout layout;
  layout.robot_side_m = side_m;
  layout.height_m = height_m;
  for (const PatchPlace& place : patches) layout.patches.push_back(place);
  return layout;
}

}  // namespace

MarkerLayout bar_layout() {
  return layout_of({{kTeamPatch, PatchOutline::kBar, 0.0175f, 0, 0.032f, 0.066f},
                    {kIdentification, PatchOutline::kSquare, -0.0175f, 0.0163f, 0.031f, 0.031f},
                    {kIdentification, PatchOutline::kSquare, -0.0175f, -0.0163f, 0.031f, 0.031f}},
                   0.075f, 0.06f);
}

MarkerLayout halves_layout() {
  return layout_of({{kTeamPatch, PatchOutline::kBar, 0, 0.019f, 0.07f, 0.034f},
                    {kIdentification, PatchOutline::kBar, 0, -0.019f, 0.07f, 0.034f}},
                   0.075f, 0.04f);
}

MarkerLayout single_layout() {
  return layout_of({{kTeamPatch, PatchOutline::kBar, 0.0175f, 0, 0.032f, 0.066f},
                    {kIdentification, PatchOutline::kSquare, -0.0175f, 0, 0.031f, 0.031f}},
                   0.075f, 0.06f);
}

MarkerLayout triangles_layout() {
  constexpr float kDiagonal = 0.099f, kSide = 0.07f;
  return layout_of(
      {{kTeamPatch, PatchOutline::kTriangle, -kDiagonal / 6, 0, kDiagonal / 2, kDiagonal, kPi},
       {kIdentification, PatchOutline::kTriangle, kDiagonal / 6, kDiagonal / 6, kSide / 2, kSide, -3 * kPi / 4},
       {kIdentification, PatchOutline::kTriangle, kDiagonal / 6, -kDiagonal / 6, kSide / 2, kSide, 3 * kPi / 4}},
      kSide, 0.05f);
}

MarkerLayout disks_layout() {
  return layout_of({{kTeamPatch, PatchOutline::kCircle, 0, 0, 0.05f, 0.05f},
                    {kIdentification, PatchOutline::kCircle, 0.035f, 0.0548f, 0.04f, 0.04f},
                    {kIdentification, PatchOutline::kCircle, -0.0548f, 0.035f, 0.04f, 0.04f},
                    {kIdentification, PatchOutline::kCircle, -0.0548f, -0.035f, 0.04f, 0.04f},
                    {kIdentification, PatchOutline::kCircle, 0.035f, -0.0548f, 0.04f, 0.04f}},
                   0.15f, 0.14f);
}

MarkerParameters teams_with(const MarkerLayout& layout, std::size_t robots) {
  constexpr std::array<ColorId, 3> kColors{kRed, kGreen, kMagenta};
  MarkerParameters parameters;
  parameters.ball.color = kOrange;
  const std::size_t slots = layout.patches.size() - 1;
  for (std::size_t t = 0; t < 2; ++t) {
    TeamMarking& team = parameters.teams[t];
    team.layout = layout;
    team.team_color = t == 0 ? kBlue : kYellow;
    team.max_robots = static_cast<std::uint8_t>(robots);
    for (std::size_t r = 0; r < robots; ++r) {
      RobotMarking robot;
      robot.id = static_cast<RobotId>(r);
      // The robot's number with colors as digits, the first two patches first.
      std::size_t rest = r;
      for (std::size_t s = 0; s < slots; ++s, rest /= kColors.size()) {
        robot.colors.push_back(kColors[(rest + s) % kColors.size()]);
      }
      team.robots.push_back(robot);
    }
  }
  return parameters;
}

}  // namespace touchline::testing
