#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/geometry/angle.h"
#include "tests/marker/literal_rules.h"
#include "tests/marker/painted_field.h"

// Three robots of one team placed as in figure 5, so that the table of possible pairs is (a), (b) or (c) of table 1.
namespace touchline::testing {
namespace {

struct Placement {
  const char* name;
  std::array<Pose, 3> robot;               // of identification patches 1, 2, 3
  std::array<std::size_t, 3> team_letter;  // letter (A = 0) of that robot's team patch
  std::vector<std::vector<bool>> table;    // rows 1 to 3, columns A to C
};

const std::vector<std::vector<bool>> kTableA{{false, false, true}, {true, false, false}, {false, true, false}};
const std::vector<std::vector<bool>> kTableB{{false, false, true}, {false, true, true}, {true, false, true}};
const std::vector<std::vector<bool>> kTableC{{false, true, true}, {true, true, false}, {true, false, false}};

const std::vector<Placement>& placements() {
  static const std::vector<Placement> all{
      {"a", {{{{-0.037f, -0.004f}, 1.3f}, {{-0.089f, 0.095f}, -3.0f}, {{0.05f, 0.069f}, -3.0f}}}, {2, 0, 1}, kTableA},
      {"a", {{{{0.098f, 0.092f}, 0.8f}, {{0.0f, -0.032f}, -2.5f}, {{-0.046f, 0.056f}, 2.3f}}}, {2, 0, 1}, kTableA},
      {"b", {{{{-0.096f, -0.024f}, -0.3f}, {{-0.097f, 0.07f}, 0.9f}, {{0.012f, 0.011f}, -0.7f}}}, {2, 1, 0}, kTableB},
      {"b", {{{{0.03f, -0.011f}, 1.1f}, {{0.07f, 0.082f}, 0.5f}, {{-0.033f, 0.057f}, 0.8f}}}, {2, 1, 0}, kTableB},
      {"b", {{{{0.028f, 0.09f}, -2.4f}, {{-0.065f, 0.058f}, 2.5f}, {{0.077f, 0.008f}, -2.0f}}}, {2, 1, 0}, kTableB},
      {"c", {{{{-0.075f, -0.07f}, 2.6f}, {{0.009f, -0.037f}, -2.6f}, {{0.079f, 0.052f}, -2.8f}}}, {2, 1, 0}, kTableC},
      {"c", {{{{0.07f, 0.061f}, -1.9f}, {{-0.006f, 0.093f}, -0.2f}, {{-0.041f, 0.0f}, -0.4f}}}, {2, 1, 0}, kTableC},
      {"c", {{{{-0.017f, -0.096f}, -2.7f}, {{0.023f, 0.01f}, -2.7f}, {{0.098f, 0.062f}, 1.9f}}}, {2, 1, 0}, kTableC}};
  return all;
}

std::vector<std::vector<bool>> table_of(const Placement& placement) {
  const MarkerLayout layout = paper_layout();
  std::vector<std::vector<bool>> table(3, std::vector<bool>(3));
  const literal::Constants k;
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t robot = 0; robot < 3; ++robot) {
      const PatchPlace &team = layout.patches[0], &identification = layout.patches[1];
      const float d = distance_m(on_field(placement.robot[row], identification.x_m, identification.y_m),
                                 on_field(placement.robot[robot], team.x_m, team.y_m));
      table[row][placement.team_letter[robot]] = k.k1_m() < d && d < k.k2_m();
    }
  }
  return table;
}

TEST(Figure5, ThePlacementsLeadToTable1) {
  for (const Placement& placement : placements()) EXPECT_EQ(table_of(placement), placement.table) << placement.name;
}

// Anywhere on the field, with any heading, under both cameras, with the small regions 4 and D of the figure.
void expect_all_found(const CameraParameters& camera) {
  const MarkerParameters parameters = paper_teams();
  PaintedField field(camera, parameters);
  for (const Placement& placement : placements()) {
    for (int turn = 0; turn < 24; ++turn) {
      const Pose group{{-0.8f + 0.07f * static_cast<float>(turn), 0.3f * static_cast<float>(turn % 5 - 2)},
                       static_cast<float>(turn) * std::numbers::pi_v<float> / 12};
      field.clear();
      std::vector<Placed> placed;
      for (std::size_t r = 0; r < 3; ++r) {
        const Pose& own = placement.robot[r];
        placed.push_back(
            {Team::kOwn,
             r,
             {on_field(group, own.position.x_m, own.position.y_m), wrap_angle(own.theta_rad + group.theta_rad)}});
      }
      field.paint(placed);
      const PixelPoint noise = field.camera().to_pixel(on_field(group, 0.2f, 0.0f), 0.0f);
      const int u = static_cast<int>(noise.u_px), v = static_cast<int>(noise.v_px);
      field.grid().at(u, v) = kBlue;
      field.grid().at(u, v + 2) = kRed;
      const Sightings& seen = field.match();
      const Comparison result = compare(placed, seen, parameters);
      EXPECT_EQ(result.right, 3u) << placement.name << ", turned by " << 15 * turn << " degrees";
      EXPECT_EQ(result.ghosts + result.missed, 0u) << placement.name;
      EXPECT_LT(result.position_m, 0.003f) << placement.name << ", turned by " << 15 * turn << " degrees";
      EXPECT_LT(result.heading_rad, 0.08f) << placement.name << ", turned by " << 15 * turn << " degrees";
      EXPECT_EQ(field.verdict_at({static_cast<float>(u), static_cast<float>(v)}), Verdict::kTooSmall);
      EXPECT_EQ(field.verdict_at({static_cast<float>(u), static_cast<float>(v + 2)}), Verdict::kTooSmall);
    }
  }
}

TEST(Figure5, AllRobotsAreFoundFromStraightAbove) { expect_all_found(straight_camera()); }
TEST(Figure5, AllRobotsAreFoundThroughATiltedLens) { expect_all_found(tilted_camera()); }

}  // namespace
}  // namespace touchline::testing
