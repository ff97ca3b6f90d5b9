#include <gtest/gtest.h>

#include <numbers>

#include "tests/marker/real_layouts.h"
#include "tests/marker/region_list.h"

// An unknown id is better than a wrong one; a position without an id is better than nothing.
namespace touchline::testing {
namespace {

const RobotSighting* of_team(const Sightings& seen, Team team) {
  for (const RobotSighting& robot : seen.robots) {
    if (robot.team == team) return &robot;
  }
  return nullptr;
}

// Opponents with arbitrary colors: red and white, which belong to no robot or to own robots.
TEST(Ambiguity, OpponentsWithUnknownColorsHavePositions) {
  MarkerParameters parameters = paper_teams();
  const MarkerParameters painted = parameters;
  parameters.teams[1].robots.clear();
  PaintedField field(straight_camera(), painted);
  Matcher matcher;
  ASSERT_TRUE(matcher.configure(parameters, field.camera()).ok());
  PaintedField seen_by(straight_camera(), parameters);
  PortableRandom random(31);
  for (int n = 0; n < 100; ++n) {
    const std::vector<Placed> placed = scattered(random, painted, 5, 1.2f, 0.9f);
    field.clear();
    field.paint(placed);
    for (const Placed& robot : placed) {
      if (robot.team == Team::kOpponent && robot.robot < 2) field.paint_patch(robot, 1, kRed);
    }
    seen_by.grid() = field.grid();
    const Sightings& seen = seen_by.match();
    const Comparison result = compare(placed, seen, painted);
    EXPECT_EQ(result.missed + result.ghosts + result.wrong, 0u) << n;
    EXPECT_EQ(result.right, 5u) << n;
    EXPECT_EQ(result.unknown, 5u) << n;
    for (const RobotSighting& robot : seen.robots) {
      EXPECT_EQ(robot.has_heading, robot.team == Team::kOwn) << n;
    }
  }
}

TEST(Ambiguity, ATeamPatchAloneIsARobotWithoutIdOrHeading) {
  const MarkerParameters parameters = paper_teams();
  PaintedField field(straight_camera(), parameters);
  const Placed robot{Team::kOwn, 0, {{-0.4f, 0.3f}, 2.0f}};
  field.paint_patch(robot, 0, kBlue);
  const Sightings& seen = field.match();
  ASSERT_EQ(seen.robots.size(), 1u);
  EXPECT_EQ(seen.robots[0].team, Team::kOwn);
  EXPECT_EQ(seen.robots[0].id, kUnknownId);
  EXPECT_FALSE(seen.robots[0].has_heading);
  EXPECT_EQ(seen.robots[0].patches.size(), 1u);
  const PatchPlace& patch = parameters.teams[0].layout.patches[0];
  EXPECT_LT(distance_m(seen.robots[0].pose.position, on_field(robot.pose, patch.x_m, patch.y_m)), 0.001f);
}

// Two identification patches at the same distance from the team patch, on different sides.
TEST(Ambiguity, TwoEquallyGoodIdentificationsGiveNoId) {
  const MarkerParameters parameters = paper_teams();
  PaintedField field(straight_camera(), parameters);
  const Placed robot{Team::kOwn, 0, {{0.1f, 0.2f}, 1.0f}};
  // If the robot is rotated by 180 degrees about its team patch, its red patch is here.
  const PatchPlace& patch = parameters.teams[0].layout.patches[0];
  const FieldPoint team_at = on_field(robot.pose, patch.x_m, patch.y_m);
  Placed other{Team::kOwn, 1, {{}, robot.pose.theta_rad + kPi}};
  const FieldPoint from = on_field(other.pose, patch.x_m, patch.y_m);
  other.pose.position = {team_at.x_m - from.x_m, team_at.y_m - from.y_m};
  field.paint(robot);
  field.paint_patch(other, 1, kGreen);
  const Sightings& seen = field.match();
  ASSERT_EQ(seen.robots.size(), 1u);
  EXPECT_EQ(seen.robots[0].id, kUnknownId);
  EXPECT_FALSE(seen.robots[0].has_heading);
}

// The same color twice: the heading is ambiguous.
TEST(Ambiguity, TwoEquallyGoodHeadingsGiveNoHeading) {
  const MarkerParameters parameters = paper_teams();
  RegionList list(straight_camera(), parameters);
  PortableRandom random(32);
  const Placed robot{Team::kOwn, 0, {{0.1f, 0.2f}, 1.0f}};
  list.add(robot, random, 0.0f);
  const PatchPlace &team = parameters.teams[0].layout.patches[0], &red = parameters.teams[0].layout.patches[1];
  const float dx = red.x_m - team.x_m, dy = red.y_m - team.y_m;
  list.add(on_field(robot.pose, team.x_m - dy, team.y_m + dx), kRed, red, 0.075f);
  const Sightings& seen = list.match();
  ASSERT_EQ(seen.robots.size(), 1u);
  EXPECT_FALSE(seen.robots[0].has_heading);
}

// Patches 7 mm from their position in the layout belong to a robot, but its id is not certain.
TEST(Ambiguity, AnImpreciseFitHasNoId) {
  const MarkerParameters parameters = paper_teams();
  RegionList list(straight_camera(), parameters);
  const PatchPlace &team = parameters.teams[0].layout.patches[0], &red = parameters.teams[0].layout.patches[1];
  const Pose pose{{0.0f, 0.3f}, -2.0f};
  for (const auto& [farther, id] : {std::pair(0.002f, 0), std::pair(0.016f, -1), std::pair(-0.016f, -1)}) {
    list.clear();
    list.add(on_field(pose, team.x_m, team.y_m), kBlue, team, 0.075f);
    const float d = farther / std::numbers::sqrt2_v<float>;
    list.add(on_field(pose, red.x_m - d, red.y_m - d), kRed, red, 0.075f);
    const Sightings& seen = list.match();
    ASSERT_EQ(seen.robots.size(), 1u);
    EXPECT_EQ(seen.robots[0].id, id) << farther;
    EXPECT_TRUE(seen.robots[0].has_heading) << farther;
    EXPECT_NEAR(seen.robots[0].residual_m, std::abs(farther) / 2, 1e-4f);
  }
}

// One of two identification patches is hidden.
TEST(Ambiguity, OneOfTwoIdentificationPatchesIsNotEnough) {
  const MarkerParameters parameters = teams_with(bar_layout(), 5);
  PaintedField field(straight_camera(), parameters);
  for (std::size_t hidden = 1; hidden <= 2; ++hidden) {
    field.clear();
    const Placed robot{Team::kOwn, 3, {{0.5f, -0.2f}, 0.7f}};
    field.paint(robot);
    field.paint_patch(robot, hidden, kBackground);
    const Sightings& seen = field.match();
    ASSERT_EQ(seen.robots.size(), 1u);
    EXPECT_EQ(seen.robots[0].id, kUnknownId);
    EXPECT_LT(distance_m(seen.robots[0].pose.position, robot.pose.position), 0.03f);
  }
}

// A pair of colors that belongs to no robot of the team.
TEST(Ambiguity, ColorsOfNoRobotGiveNoId) {
  const MarkerParameters parameters = teams_with(bar_layout(), 3);
  PaintedField field(straight_camera(), parameters);
  const Placed robot{Team::kOpponent, 0, {{-0.5f, -0.2f}, -1.7f}};
  field.paint_patch(robot, 0, kYellow);
  field.paint_patch(robot, 1, kMagenta);
  field.paint_patch(robot, 2, kRed);
  const Sightings& seen = field.match();
  ASSERT_EQ(seen.robots.size(), 1u);
  EXPECT_EQ(seen.robots[0].team, Team::kOpponent);
  EXPECT_EQ(seen.robots[0].id, kUnknownId);
}

// Two robots show the same id. One of them has a wrong patch, but it is unknown which one.
TEST(Ambiguity, AnIdIsNeverReportedTwice) {
  const MarkerParameters parameters = paper_teams();
  PaintedField field(straight_camera(), parameters);
  field.paint(std::vector<Placed>{{Team::kOwn, 2, {{-0.5f, 0.1f}, 1.0f}}, {Team::kOwn, 2, {{0.5f, -0.1f}, -1.0f}}});
  const Sightings& seen = field.match();
  ASSERT_EQ(seen.robots.size(), 2u);
  for (const RobotSighting& robot : seen.robots) EXPECT_EQ(robot.id, kUnknownId);
}

TEST(Ambiguity, MoreRobotsThanPlayAreNotReported) {
  MarkerParameters parameters = paper_teams();
  const MarkerParameters painted = parameters;
  parameters.teams[0].max_robots = 3;
  PortableRandom random(33);
  PaintedField field(straight_camera(), painted);
  PaintedField seen_by(straight_camera(), parameters);
  field.paint(scattered(random, painted, 5, 1.5f, 1.2f));
  seen_by.grid() = field.grid();
  const Sightings& seen = seen_by.match();
  EXPECT_EQ(std::count_if(seen.robots.begin(), seen.robots.end(), [](const auto& r) { return r.team == Team::kOwn; }),
            3);
  EXPECT_EQ(seen.robots.size(), 8u);
}

TEST(Ambiguity, TeamsWithoutAColorAreNotSearched) {
  MarkerParameters parameters = paper_teams();
  const MarkerParameters painted = parameters;
  parameters.teams[1] = {};
  PortableRandom random(34);
  PaintedField field(straight_camera(), painted);
  PaintedField seen_by(straight_camera(), parameters);
  field.paint(scattered(random, painted, 5, 1.5f, 1.2f));
  seen_by.grid() = field.grid();
  const Sightings& seen = seen_by.match();
  EXPECT_EQ(seen.robots.size(), 5u);
  EXPECT_EQ(of_team(seen, Team::kOpponent), nullptr);
}

}  // namespace
}  // namespace touchline::testing
