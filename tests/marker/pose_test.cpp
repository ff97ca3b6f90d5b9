#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/geometry/angle.h"
#include "tests/marker/literal_rules.h"
#include "tests/marker/real_layouts.h"
#include "tests/marker/region_list.h"

// Eq. (3), the refinement of centers before it, and the geometry that both use.
namespace touchline::testing {
namespace {

TEST(Pose, TheRigidFitOfThePapersTwoPatchesIsEquation3) {
  PortableRandom random(21);
  const MarkerLayout layout = paper_layout();
  for (int n = 0; n < 1000; ++n) {
    // Also for patches whose measured distance is too small or too large.
    const FieldPoint team{random.real(-1, 1), random.real(-1, 1)};
    const FieldPoint identification{team.x_m + random.real(-0.06f, 0.06f), team.y_m + random.real(-0.06f, 0.06f)};
    if (distance_m(team, identification) < 0.01f) continue;
    const std::array<Correspondence, 2> points{{{{layout.patches[0].x_m, layout.patches[0].y_m}, team},
                                                {{layout.patches[1].x_m, layout.patches[1].y_m}, identification}}};
    const RigidFit fit = fit_rigidly(points);
    const Pose expected = literal::pose(team, identification);
    EXPECT_NEAR(fit.pose.position.x_m, expected.position.x_m, 1e-6f);
    EXPECT_NEAR(fit.pose.position.y_m, expected.position.y_m, 1e-6f);
    EXPECT_NEAR(wrap_angle(fit.pose.theta_rad - expected.theta_rad), 0.0f, 1e-4f);
    const float error = distance_m(team, identification) - std::hypot(0.0375f, 0.0375f);
    EXPECT_NEAR(fit.residual_m, std::abs(error) / 2, 1e-6f);
  }
}

TEST(Pose, TheRigidFitNeitherMirrorsNorScales) {
  const std::array<Correspondence, 3> mirrored{
      {{{0.03f, 0}, {0.03f, 0}}, {{0, 0.02f}, {0, -0.02f}}, {{0, -0.02f}, {0, 0.02f}}}};
  EXPECT_GT(fit_rigidly(mirrored).residual_m, 0.01f);
  const std::array<Correspondence, 2> twice{{{{0.01f, 0}, {0.02f, 0}}, {{-0.01f, 0}, {-0.02f, 0}}}};
  EXPECT_NEAR(fit_rigidly(twice).residual_m, 0.01f, 1e-6f);
}

TEST(Pose, TheLimitOfTheResidualOnlySortsOutWorseFits) {
  PortableRandom random(22);
  int within = 0;
  for (int n = 0; n < 2000; ++n) {
    std::array<Correspondence, 6> points{};
    const float error = random.real(0.0f, 0.02f);
    for (Correspondence& p : points) {
      p.place = {random.real(-0.04f, 0.04f), random.real(-0.04f, 0.04f)};
      p.seen = {1.0f - p.place.y_m + random.real(-error, error), 0.5f + p.place.x_m + random.real(-error, error)};
    }
    const std::span<const Correspondence> seen(points.data(), 2 + static_cast<std::size_t>(n) % 5);
    const RigidFit expected = fit_rigidly(seen);
    // Also limits that hardly differ from the residual.
    for (const float most : {0.008f, expected.residual_m, std::nextafter(expected.residual_m, 0.0f)}) {
      RigidFit fit;
      const bool is_within = fit_rigidly_within(most, seen, fit);
      EXPECT_EQ(is_within, expected.residual_m <= most) << n;
      if (!is_within) continue;
      ++within;
      EXPECT_EQ(fit.pose.theta_rad, expected.pose.theta_rad);
      EXPECT_EQ(fit.pose.position.x_m, expected.pose.position.x_m);
      EXPECT_EQ(fit.residual_m, expected.residual_m);
    }
  }
  EXPECT_GT(within, 3000);
  EXPECT_LT(within, 3900);
}

TEST(Pose, TheNoiseOfTheRigidFitFollowsFromThatOfThePoints) {
  const std::array<FieldPoint, 3> places{{{0.03f, 0.01f}, {-0.02f, 0.025f}, {0.005f, -0.03f}}};
  const std::array<PointCovariance, 3> errors{{{4e-8f, 1e-8f, 1e-8f}, {1e-8f, 0.0f, 9e-8f}, {2e-8f, -1e-8f, 2e-8f}}};
  const Pose truth{{0.4f, -0.3f}, 2.1f};
  const PoseCovariance expected = rigid_fit_noise(places, errors, truth.theta_rad);
  std::mt19937 random(31);
  std::normal_distribution<float> normal;
  constexpr int kRuns = 20000;
  std::array<double, 6> sums{};  // in the order of PoseCovariance
  for (int run = 0; run < kRuns; ++run) {
    std::array<Correspondence, 3> points;
    for (std::size_t k = 0; k < points.size(); ++k) {
      // Cholesky factors of the covariances.
      const float a = std::sqrt(errors[k].xx), b = errors[k].xy / a, c = std::sqrt(errors[k].yy - b * b);
      const float first = normal(random), second = normal(random);
      const FieldPoint own{places[k].x_m + a * first, places[k].y_m + b * first + c * second};
      points[k] = {places[k], on_field(truth, own.x_m, own.y_m)};
    }
    const Pose found = fit_rigidly(points).pose;
    const auto x = static_cast<double>(found.position.x_m - truth.position.x_m);
    const auto y = static_cast<double>(found.position.y_m - truth.position.y_m);
    const auto t = static_cast<double>(wrap_angle(found.theta_rad - truth.theta_rad));
    const std::array<double, 6> products{x * x, y * y, t * t, x * y, x * t, y * t};
    for (std::size_t i = 0; i < products.size(); ++i) sums[i] += products[i] / kRuns;
  }
  const std::array<float, 6> stated{expected.xx, expected.yy, expected.tt, expected.xy, expected.xt, expected.yt};
  const std::array<double, 6> scale{sums[0],
                                    sums[1],
                                    sums[2],
                                    std::sqrt(sums[0] * sums[1]),
                                    std::sqrt(sums[0] * sums[2]),
                                    std::sqrt(sums[1] * sums[2])};
  for (std::size_t i = 0; i < sums.size(); ++i) {
    EXPECT_NEAR(static_cast<double>(stated[i]) / scale[i], sums[i] / scale[i], 0.05) << i;
  }
  EXPECT_GT(std::abs(sums[3]) / scale[3], 0.1) << "otherwise the test says little about the axes";
}

// Exact projections of patches must give exact poses, for any height of the patches.
TEST(Pose, LensTiltAndHeightLeaveNoTrace) {
  for (const CameraParameters& camera : {straight_camera(), tilted_camera()}) {
    for (const float height : {0.0f, 0.075f, 0.15f}) {
      MarkerParameters parameters = paper_teams();
      parameters.teams[0].layout.height_m = height;
      parameters.teams[1].layout.height_m = 0.5f * height;
      RegionList list(camera, parameters);
      PortableRandom random(22);
      for (int n = 0; n < 100; ++n) {
        list.clear();
        const std::vector<Placed> placed = scattered(random, parameters, 5, 1.9f, 1.5f);
        for (const Placed& robot : placed) list.add(robot, random, 0.0f);
        const Comparison result = compare(placed, list.match(), parameters);
        ASSERT_EQ(result.right, placed.size());
        EXPECT_LT(result.position_m, 2e-5f);
        EXPECT_LT(result.heading_rad, 1e-3f);
      }
    }
  }
}

// With a camera at 2 m, ignoring a height of 75 mm moves a robot at 1 m from the middle by 39 mm.
TEST(Pose, AWrongHeightMovesTheRobot) {
  MarkerParameters parameters = paper_teams();
  const std::vector<Placed> placed{{Team::kOwn, 0, {{1.0f, 0.0f}, 0.5f}}};
  RegionList list(straight_camera(), parameters);
  PortableRandom random(23);
  list.add(placed[0], random, 0.0f);
  Matcher on_the_floor;
  for (TeamMarking& team : parameters.teams) team.layout.height_m = 0.0f;
  ASSERT_TRUE(on_the_floor.configure(parameters, list.camera()).ok());
  const auto runs = std::make_unique<Runs>();
  const auto seen = std::make_unique<Sightings>();
  on_the_floor.match(*runs, list.regions(), *seen);
  ASSERT_EQ(seen->robots.size(), 1u);
  EXPECT_NEAR(seen->robots[0].pose.position.x_m, 1.0f / (1 - 0.075f / 2), 1e-4f);
}

// A scratch or a highlight divides a patch, and a screw leaves a hole. The weighted mean is the center of the patch.
TEST(Refinement, FragmentsAreAveragedByTheirAreas) {
  const MarkerParameters parameters = paper_teams();
  PaintedField field(straight_camera(), parameters);
  PortableRandom random(24);
  for (int n = 0; n < 200; ++n) {
    const Placed robot{Team::kOwn, 1, {{random.real(-0.9f, 0.9f), random.real(-0.7f, 0.7f)}, random.real(-kPi, kPi)}};
    field.clear();
    field.paint(robot);
    const Sightings whole = field.match();
    ASSERT_EQ(whole.robots.size(), 1u);
    // A cut of 6 mm across the team patch, at any place.
    const float cut = random.real(0.006f, 0.026f);
    field.paint_part(robot, {cut, -0.04f}, {cut + 0.006f, 0.04f}, kBackground);
    const Sightings& seen = field.match();
    ASSERT_EQ(seen.robots.size(), 1u) << n;
    EXPECT_EQ(seen.robots[0].id, 1) << n;
    // The mean of the remaining pixels is at most half the width of the cut from the center.
    EXPECT_LT(distance_m(seen.robots[0].pose.position, whole.robots[0].pose.position), 0.003f) << n;
    ASSERT_EQ(seen.robots[0].patches.size(), 2u);
    float u = 0, v = 0, area = 0;
    for (const Region& region : field.regions()) {
      if (region.color != kBlue) continue;
      u += region.centroid.u_px * static_cast<float>(region.area_px);
      v += region.centroid.v_px * static_cast<float>(region.area_px);
      area += static_cast<float>(region.area_px);
    }
    EXPECT_NEAR(seen.robots[0].patches[0].center.u_px, u / area, 0.01f) << n;
    EXPECT_NEAR(seen.robots[0].patches[0].center.v_px, v / area, 0.01f) << n;
  }
}

// Fragments beyond d1, or those that would make the patch too large, are not merged.
TEST(Refinement, DoesNotMergeOtherPatches) {
  const MarkerParameters parameters = paper_teams();
  RegionList list(straight_camera(), parameters);
  PortableRandom random(25);
  const Placed robot{Team::kOwn, 0, {{0.3f, 0.2f}, 0.4f}};
  const PatchPlace& patch = parameters.teams[0].layout.patches[0];
  for (const auto& [distance, ratio, merged] :
       {std::tuple(0.030f, 0.05f, true), std::tuple(0.038f, 0.05f, false), std::tuple(0.020f, 0.7f, false)}) {
    list.clear();
    list.add(robot, random, 0.0f);
    list.add(on_field(robot.pose, patch.x_m + distance, patch.y_m), kBlue, patch, 0.075f, ratio);
    const Sightings& seen = list.match();
    ASSERT_EQ(seen.robots.size(), 1u);
    EXPECT_EQ(seen.robots[0].id, 0);
    const float moved = distance_m(seen.robots[0].pose.position, robot.pose.position);
    if (merged) {
      EXPECT_NEAR(moved, 0.5f * distance * ratio / (1 + ratio), 5e-5f);
    } else {
      EXPECT_LT(moved, 1e-4f);
    }
    EXPECT_EQ(seen.verdicts[2], merged ? Verdict::kFragment : ratio > 0.5f ? Verdict::kTooClose : Verdict::kTooSmall);
  }
}

}  // namespace
}  // namespace touchline::testing
