#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/geometry/angle.h"
#include "core/marker/rigid_fit.h"
#include "tests/marker/real_layouts.h"

// Disturbed pictures: whatever is missing or added, no robot may get the id of another one.
namespace touchline::testing {
namespace {

struct NoiseCase {
  const char* name;
  MarkerParameters (*teams)();
  std::size_t robots;
  float least_right;  // of all robots, over all pictures
};

void PrintTo(const NoiseCase& c, std::ostream* out) { *out << c.name; }

class Noise : public ::testing::TestWithParam<NoiseCase> {
 protected:
  // Pixels that change to the color of a neighbor or to any color.
  void sprinkle(PaintedField& field, float part) {
    ColorGrid& grid = field.grid();
    const int count = static_cast<int>(part * static_cast<float>(grid.width * grid.height));
    for (int i = 0; i < count; ++i) {
      const int u = random.whole(1, grid.width - 2), v = random.whole(1, grid.height - 2);
      const bool copy = random.whole(0, 3) > 0;
      grid.at(u, v) = copy ? grid.at(u + random.whole(-1, 1), v + random.whole(-1, 1))
                           : static_cast<ColorId>(random.whole(0, 1) * random.whole(0, kPink));
    }
  }
  // A stick, a hand or a cable: a band of background across the robot, up to half a robot wide.
  void hide(PaintedField& field, const Placed& robot) {
    Placed turned = robot;
    turned.pose.theta_rad += random.real(-kPi, kPi);
    const float from = random.real(-0.04f, 0.04f);
    field.paint_part(turned, {from, -0.2f}, {from + random.real(0.005f, 0.04f), 0.2f}, kBackground);
  }
  // A piece of colored paper on the field, of any size up to that of a patch and a half, in any of the colors.
  void litter(PaintedField& field, FieldPoint at) {
    const Placed paper{Team::kOwn, 0, {at, random.real(-kPi, kPi)}};
    const float length = random.real(0.004f, 0.04f), width = random.real(0.004f, 0.04f);
    const auto color = static_cast<ColorId>(random.whole(kBlue, kPink));
    field.paint_part(paper, {-length / 2, -width / 2}, {length / 2, width / 2}, color);
  }

  PortableRandom random{61};
};

TEST_P(Noise, NoRobotGetsTheIdOfAnother) {
  const MarkerParameters parameters = GetParam().teams();
  const float side = parameters.teams[0].layout.robot_side_m;
  std::size_t robots = 0, right = 0, wrong = 0;
  for (const CameraParameters& camera : {straight_camera(), tilted_camera()}) {
    PaintedField field(camera, parameters);
    for (int n = 0; n < 30; ++n) {
      field.clear();
      const float extent = (n % 2 == 0 ? 16.0f : 7.0f) * side;
      const std::vector<Placed> placed = scattered(random, parameters, GetParam().robots, extent, extent);
      field.paint(placed);
      for (const Placed& robot : placed) {
        if (random.whole(0, 3) == 0) hide(field, robot);
      }
      // Not on a robot: a patch of another color on top of a robot's own patch would be a forged id, not noise.
      for (int i = 0; i < 8; ++i) {
        const FieldPoint at{random.real(-extent, extent), random.real(-extent, extent)};
        const Pose paper{at, 0};
        if (std::none_of(placed.begin(), placed.end(),
                         [&](const Placed& p) { return overlap(p.pose, paper, side + 0.03f); })) {
          litter(field, at);
        }
      }
      sprinkle(field, 0.01f * static_cast<float>(n % 3));
      const Comparison result = compare(placed, field.match(), parameters);
      wrong += result.wrong;
      EXPECT_EQ(result.wrong, 0u) << "picture " << n;
      robots += placed.size();
      right += result.right;
    }
  }
  EXPECT_EQ(wrong, 0u) << "of " << robots;
  EXPECT_GT(static_cast<float>(right), GetParam().least_right * static_cast<float>(robots))
      << right << " of " << robots;
}

// Dots of 2 x 2 pixels, each too small for a partly visible patch. Together they cover four ninths of every patch.
TEST(CrumbledPatches, AreMergedFromTheirPieces) {
  const MarkerParameters parameters = paper_teams();
  PortableRandom random{5};
  PaintedField field(straight_camera(), parameters);
  const std::vector<Placed> placed = scattered(random, parameters, 5, 1.0f, 1.0f);
  field.paint(placed);
  ColorGrid& grid = field.grid();
  for (int v = 0; v < grid.height; ++v) {
    for (int u = 0; u < grid.width; ++u) {
      if (u % 3 == 2 || v % 3 == 2) grid.at(u, v) = kBackground;
    }
  }
  const Comparison result = compare(placed, field.match(), parameters);
  EXPECT_EQ(result.wrong, 0u);
  EXPECT_GE(result.right, 8u) << "of " << placed.size();
}

// A quarter to a half of a patch has no color. The region's center moves, and the stated error must cover this.
TEST(TornPatches, StateTheirError) {
  const MarkerParameters parameters = paper_teams();
  const MarkerLayout& layout = parameters.teams[0].layout;
  PortableRandom random{8};
  PaintedField field(tilted_camera(), parameters);
  int torn = 0, far = 0;
  float farthest_m = 0;
  for (int n = 0; n < 60; ++n) {
    const Placed robot{Team::kOwn,
                       static_cast<std::size_t>(n % 5),
                       {{random.real(-0.8f, 0.8f), random.real(-0.6f, 0.6f)}, random.real(-kPi, kPi)}};
    const auto seen = [&]() -> const RobotSighting* {
      const Sightings& all = field.match();
      return all.robots.size() == 1 && all.robots[0].has_heading && all.robots[0].patches.size() == 2 ? &all.robots[0]
                                                                                                      : nullptr;
    };
    const auto sigma_m = [](const RobotSighting& sighting) { return std::sqrt(sighting.noise.xx + sighting.noise.yy); };
    field.clear();
    field.paint(robot);
    const RobotSighting* const intact = seen();
    ASSERT_NE(intact, nullptr);
    // The error is a fifth of a pixel for each coordinate of a center. Whole pixels seldom leave a residual that
    // explains more.
    const float usual_m = 0.2f / field.camera().scale_px_per_m(intact->pose.position, layout.height_m);
    EXPECT_NEAR(sigma_m(*intact), usual_m, 0.05f * usual_m);
    // From one side of the patch.
    const PatchPlace& place = layout.patches[n % 2 == 0 ? 0 : 1];
    const float half = 0.5f * place.length_m, rest = half - place.length_m * random.real(0.25f, 0.5f);
    FieldPoint low{place.x_m - half, place.y_m - half}, high{place.x_m + half, place.y_m + half};
    switch (random.whole(0, 3)) {
      case 0:
        low.x_m = place.x_m + rest;
        break;
      case 1:
        high.x_m = place.x_m - rest;
        break;
      case 2:
        low.y_m = place.y_m + rest;
        break;
      default:
        high.y_m = place.y_m - rest;
        break;
    }
    field.paint_part(robot, low, high, kBackground);
    const RobotSighting* const sighting = seen();
    if (sighting == nullptr) continue;
    ++torn;
    const float error_m = distance_m(sighting->pose.position, robot.pose.position);
    far += error_m > 0.002f ? 1 : 0;
    farthest_m = std::max(farthest_m, error_m);
    EXPECT_LE(error_m, 3.0f * sigma_m(*sighting)) << "picture " << n << ", residual " << sighting->residual_m;
    EXPECT_LE(std::abs(wrap_angle(sighting->pose.theta_rad - robot.pose.theta_rad)),
              3.0f * std::sqrt(sighting->noise.tt))
        << "picture " << n;
  }
  EXPECT_GE(torn, 40);
  EXPECT_GE(far, 20) << "of " << torn << ", farthest " << farthest_m;
}

// In all layouts but the first, both teams have the same identification colors.
INSTANTIATE_TEST_SUITE_P(Marker, Noise,
                         ::testing::Values(NoiseCase{"own_colors", paper_teams, 5, 0.7f},
                                           NoiseCase{"paper", [] { return teams_with(paper_layout(), 3); }, 3, 0.7f},
                                           NoiseCase{"bar", [] { return teams_with(bar_layout(), 5); }, 5, 0.7f},
                                           NoiseCase{"halves", [] { return teams_with(halves_layout(), 3); }, 3, 0.7f},
                                           NoiseCase{"single", [] { return teams_with(single_layout(), 3); }, 3, 0.7f},
                                           NoiseCase{"triangles", [] { return teams_with(triangles_layout(), 5); }, 5,
                                                     0.7f},
                                           NoiseCase{"disks", [] { return teams_with(disks_layout(), 6); }, 6, 0.7f}),
                         ::testing::PrintToStringParamName());

}  // namespace
}  // namespace touchline::testing
