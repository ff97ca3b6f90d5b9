#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <ctime>
#include <numbers>

#include "tests/marker/painted_field.h"
#include "tests/marker/region_list.h"

// Verdicts of regions, and the bounds of the search.
namespace touchline::testing {
namespace {

constexpr float kHeight = 0.075f;

class Verdicts : public ::testing::Test {
 protected:
  [[nodiscard]] const PatchPlace& patch() const { return parameters.teams[0].layout.patches[0]; }
  // Adds a region and returns its verdict.
  std::size_t add(FieldPoint at, ColorId color, float ratio) {
    list.add(at, color, patch(), kHeight, ratio);
    return list.regions().size() - 1;
  }
  MarkerParameters parameters = paper_teams();
  RegionList list{straight_camera(), parameters};
  PortableRandom random{41};
};

TEST_F(Verdicts, EveryRegionHasOne) {
  const Placed robot{Team::kOwn, 0, {{0.4f, 0.2f}, 0.3f}};
  list.add(robot, random, 0.0f);  // regions 0 and 1
  const std::size_t strange = add({0.0f, 0.0f}, kWhite + 1, 1.0f);
  const std::size_t small = add({0.0f, 0.1f}, kRed, 0.2f);
  const std::size_t flood = add({0.0f, -0.3f}, kGreen, 6.0f);
  const std::size_t outside = add({1.25f, 0.5f}, kBlue, 1.0f);
  const std::size_t alone = add({-0.5f, 0.5f}, kRed, 0.9f);
  const std::size_t team_alone = add({-0.8f, -0.5f}, kYellow, 1.0f);
  const std::size_t faint_team = add({-0.8f, 0.5f}, kYellow, 0.4f);
  const std::size_t ball = add({-0.2f, -0.5f}, kOrange, 1.2f);
  const Sightings& seen = list.match();
  EXPECT_EQ(seen.verdicts[0], Verdict::kTeamPatch);
  EXPECT_EQ(seen.verdicts[1], Verdict::kIdentification);
  EXPECT_EQ(seen.verdicts[strange], Verdict::kNotExamined);
  EXPECT_EQ(seen.verdicts[small], Verdict::kTooSmall);
  EXPECT_EQ(seen.verdicts[flood], Verdict::kTooLarge);
  EXPECT_EQ(seen.verdicts[outside], Verdict::kOutsideField);
  EXPECT_EQ(seen.verdicts[alone], Verdict::kNoPartner);
  EXPECT_EQ(seen.verdicts[team_alone], Verdict::kTeamPatch);
  EXPECT_EQ(seen.verdicts[faint_team], Verdict::kNoPartner);
  EXPECT_EQ(seen.verdicts[ball], Verdict::kBall);
  EXPECT_EQ(seen.robots.size(), 2u);
  EXPECT_TRUE(seen.ball.seen);
}

TEST_F(Verdicts, APartnerThatIsTaken) {
  const Placed robot{Team::kOwn, 0, {{0.4f, 0.2f}, 0.3f}};
  list.add(robot, random, 0.0f);
  // Another red patch at the right distance from the team patch, with a worse fit.
  const std::size_t other = add(on_field(robot.pose, patch().x_m - 0.045f, patch().y_m + 0.045f), kRed, 1.0f);
  const Sightings& seen = list.match();
  ASSERT_EQ(seen.robots.size(), 1u);
  EXPECT_EQ(seen.robots[0].id, 0);
  EXPECT_EQ(seen.verdicts[1], Verdict::kIdentification);
  EXPECT_EQ(seen.verdicts[other], Verdict::kPartnerTaken);
}

TEST_F(Verdicts, ATeamRegionOnTheTopOfARobotIsNoOtherRobot) {
  const Placed robot{Team::kOwn, 0, {{0.4f, 0.2f}, 0.3f}};
  list.add(robot, random, 0.0f);
  const std::size_t stranger = add(on_field(robot.pose, 0.019f, -0.019f), kYellow, 0.8f);
  const Sightings& seen = list.match();
  EXPECT_EQ(seen.robots.size(), 1u);
  EXPECT_EQ(seen.verdicts[stranger], Verdict::kTooClose);
}

// The paper's "proper number of regions with the biggest area": a hundred patches of one color.
TEST_F(Verdicts, OnlyTheLargestAreUsed) {
  for (int i = 0; i < 100; ++i) {
    add({-0.95f + 0.1f * static_cast<float>(i % 20), -0.6f + 0.3f * static_cast<float>(i / 20)}, kBlue,
        i % 2 == 0 ? 1.0f : 0.8f);
  }
  const Sightings& seen = list.match();
  ASSERT_EQ(seen.robots.size(), 5u);
  int team_patches = 0, surplus = 0;
  for (std::size_t i = 0; i < seen.verdicts.size(); ++i) {
    team_patches += seen.verdicts[i] == Verdict::kTeamPatch ? 1 : 0;
    surplus += seen.verdicts[i] == Verdict::kSurplus ? 1 : 0;
    EXPECT_TRUE(seen.verdicts[i] != Verdict::kTeamPatch || i % 2 == 0) << "a smaller one";
  }
  EXPECT_EQ(team_patches, 5);
  EXPECT_EQ(surplus, 95);
}

TEST_F(Verdicts, ARobotIsReportedOnceWithAllItsPatches) {
  const Placed robot{Team::kOpponent, 3, {{0.4f, 0.2f}, 0.3f}};
  list.add(robot, random, 0.0f);
  const Sightings& seen = list.match();
  ASSERT_EQ(seen.robots.size(), 1u);
  const RobotSighting& sighted = seen.robots[0];
  ASSERT_EQ(sighted.patches.size(), 2u);
  EXPECT_EQ(sighted.patches[0].role, PatchRole::kTeam);
  EXPECT_EQ(sighted.patches[0].patch, 0);
  EXPECT_EQ(sighted.patches[0].color, kYellow);
  EXPECT_EQ(sighted.patches[1].role, PatchRole::kIdentification);
  EXPECT_EQ(sighted.patches[1].patch, 1);
  EXPECT_EQ(sighted.patches[1].color, kGrey);
  for (std::size_t p = 0; p < 2; ++p) {
    EXPECT_FLOAT_EQ(sighted.patches[p].center.u_px, list.regions()[p].centroid.u_px);
    EXPECT_FLOAT_EQ(sighted.patches[p].center.v_px, list.regions()[p].centroid.v_px);
  }
}

// Dense patches in which every team patch has dozens of partners. The search stops early, sets cut_short, and reports
// no id and no more robots than the maximum number.
TEST(Bounds, DensePatchesAreCutShort) {
  const MarkerParameters parameters = paper_teams();
  RegionList list(straight_camera(), parameters);
  const PatchPlace& patch = parameters.teams[0].layout.patches[0];
  constexpr std::array<ColorId, 6> kColors{kRed, kBlue, kGreen, kMagenta, kYellow, kCyan};
  std::size_t n = 0;
  for (int row = 0; row < 24; ++row) {
    for (int column = 0; column < 24; ++column) {
      list.add({-0.36f + 0.03f * static_cast<float>(column), -0.36f + 0.03f * static_cast<float>(row)},
               kColors[n++ % kColors.size()], patch, kHeight);
    }
    ++n;
  }
  const Sightings& seen = list.match();
  EXPECT_TRUE(seen.cut_short);
  EXPECT_LE(seen.robots.size(), 10u);
  EXPECT_FALSE(seen.robots.empty());
  for (const RobotSighting& robot : seen.robots) EXPECT_EQ(robot.id, kUnknownId);
}

// Sixteen patches of one color around each team patch, any five of which may belong to a robot. A complete search would
// visit a million partial sets for each, which would take seconds. The best ones exclude the rest.
TEST(Bounds, NotAllFittingSetsAreTried) {
  MarkerParameters parameters = paper_teams();
  MarkerLayout& layout = parameters.teams[0].layout;
  layout.patches.clear();
  layout.robot_side_m = 0.09f;
  layout.patches.push_back({PatchRole::kTeam, PatchOutline::kSquare, 0, 0, 0.02f, 0.02f});
  const auto around = [](int part, int of) {
    const float angle = 2 * std::numbers::pi_v<float> * static_cast<float>(part) / static_cast<float>(of);
    return FieldPoint{0.025f * std::cos(angle), 0.025f * std::sin(angle)};
  };
  RobotMarking robot;
  robot.id = 0;
  for (int i = 0; i < 5; ++i) {
    const FieldPoint at = around(i, 5);
    layout.patches.push_back({PatchRole::kIdentification, PatchOutline::kSquare, at.x_m, at.y_m, 0.008f, 0.008f});
    robot.colors.push_back(kRed);
  }
  parameters.teams[0].robots.clear();
  parameters.teams[0].robots.push_back(robot);
  RegionList list(straight_camera(), parameters);
  for (int i = 0; i < 3; ++i) {
    const float x_m = 0.3f * static_cast<float>(i);
    list.add({x_m, 0}, parameters.teams[0].team_color, layout.patches[0], layout.height_m);
    for (int k = 0; k < 16; ++k) {
      const FieldPoint at = around(k, 16);
      list.add({x_m + at.x_m, at.y_m}, kRed, layout.patches[1], layout.height_m);
    }
  }
  const std::clock_t begin = std::clock();
  EXPECT_FALSE(list.match().cut_short);
  EXPECT_LT(static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC, 0.3);
}

// Noise in every pixel, and a checkerboard of single pixels: many regions, no patches.
TEST(Bounds, APictureOfNoiseHasNoRobots) {
  const MarkerParameters parameters = paper_teams();
  PaintedField field(straight_camera(), parameters);
  PortableRandom random(42);
  for (int n = 0; n < 3; ++n) {
    // As many regions as the scan can produce.
    for (int v = 0; v < 200; v += 2) {
      for (int u = 0; u < 78; u += 2) field.grid().at(8 * u, 2 * v) = static_cast<ColorId>(random.whole(1, kWhite));
    }
    const Sightings& seen = field.match();
    EXPECT_EQ(seen.verdicts.size(), field.regions().size());
    EXPECT_TRUE(seen.robots.empty());
    EXPECT_FALSE(seen.ball.seen);
  }
}

// The same picture gives the same bits, regardless of former pictures.
TEST(Bounds, FramesAreIndependent) {
  const MarkerParameters parameters = paper_teams();
  RegionList used(straight_camera(), parameters), fresh(straight_camera(), parameters);
  PortableRandom random(43);
  for (int n = 0; n < 50; ++n) {
    const std::vector<Placed> placed = scattered(random, parameters, 5, 0.6f, 0.6f);
    used.clear();
    PortableRandom error(static_cast<std::uint32_t>(n));
    for (const Placed& robot : placed) used.add(robot, error, 0.002f);
    used.match();
  }
  PortableRandom place(44);
  const std::vector<Placed> placed = scattered(place, parameters, 5, 0.6f, 0.6f);
  used.clear();
  for (RegionList* list : {&used, &fresh}) {
    PortableRandom error(1);
    for (const Placed& robot : placed) list->add(robot, error, 0.002f);
  }
  const Sightings &a = used.match(), &b = fresh.match();
  ASSERT_EQ(a.robots.size(), b.robots.size());
  for (std::size_t i = 0; i < a.robots.size(); ++i) {
    EXPECT_EQ(a.robots[i].id, b.robots[i].id);
    EXPECT_EQ(std::memcmp(&a.robots[i].pose, &b.robots[i].pose, sizeof(Pose)), 0);
  }
  EXPECT_TRUE(std::equal(a.verdicts.begin(), a.verdicts.end(), b.verdicts.begin(), b.verdicts.end()));
}

}  // namespace
}  // namespace touchline::testing
