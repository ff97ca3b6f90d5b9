#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "tests/marker/real_layouts.h"

// A stick, a hand or another robot's flag hides most of a team patch. The visible part shows the team, and the complete
// identification patch shows the robot: the left-over rule of section 5 for a column that is almost empty.
namespace touchline::testing {
namespace {

class HiddenPatch : public ::testing::Test {
 protected:
  // Paints the robot with its team patch covered except for a part, from a random direction.
  void paint(PaintedField& field, const Placed& robot, float visible) {
    const PatchPlace& place = field.marking(robot.team).layout.patches[0];
    const auto pixels = [&] { return field.pixels_of(field.marking(robot.team).team_color); };
    field.clear();
    field.paint_patch(robot, 0, field.marking(robot.team).team_color);
    const auto whole = static_cast<float>(pixels());
    // Moves the edge of the cover over the patch until only this part is visible. It does not reach the other patches.
    const bool from_left = random.whole(0, 1) == 0;
    for (float edge = 0.0f; static_cast<float>(pixels()) > visible * whole; edge += 0.001f) {
      const float side = from_left ? -1.0f : 1.0f;
      const float from = place.y_m + side * place.width_m / 2, to = from - side * edge;
      field.paint_part(robot, {place.x_m - place.length_m, std::min(from, to)},
                       {place.x_m + place.length_m, std::max(from, to)}, kBackground);
    }
    left = static_cast<float>(pixels()) / whole;
    for (std::size_t s = 0; s + 1 < field.marking(robot.team).layout.patches.size(); ++s) {
      field.paint_patch(robot, s + 1, field.marking(robot.team).robots[robot.robot].colors[s]);
    }
  }
  Placed anywhere(Team team, std::size_t robot) {
    return {team, robot, {{random.real(-0.9f, 0.9f), random.real(-0.7f, 0.7f)}, random.real(-kPi, kPi)}};
  }
  PortableRandom random{71};
  float left = 0;  // visible fraction of the team patch
};

TEST_F(HiddenPatch, APartlyVisibleTeamPatchAndItsIdentificationAreARobot) {
  const MarkerParameters parameters = paper_teams();
  for (const CameraParameters& camera : {straight_camera(), tilted_camera()}) {
    PaintedField field(camera, parameters);
    int found = 0;
    constexpr int kPictures = 40;
    for (int n = 0; n < kPictures; ++n) {
      const Placed robot = anywhere(n % 2 == 0 ? Team::kOwn : Team::kOpponent, static_cast<std::size_t>(n % 5));
      paint(field, robot, random.real(0.12f, 0.32f));
      const Sightings& seen = field.match();
      if (seen.robots.empty()) continue;  // a strip less than a pixel wide
      ++found;
      ASSERT_EQ(seen.robots.size(), 1u) << n;
      EXPECT_EQ(seen.robots[0].team, robot.team) << n;
      EXPECT_EQ(seen.robots[0].id, static_cast<RobotId>(robot.robot)) << n;
      EXPECT_FALSE(seen.robots[0].has_heading) << "visible: " << left;
      EXPECT_EQ(seen.robots[0].patches.size(), 2u) << n;
      EXPECT_LT(distance_m(seen.robots[0].pose.position, robot.pose.position), 0.012f) << n;
    }
    EXPECT_GT(found, kPictures * 9 / 10);
  }
}

// Two identification patches give the whole pose.
TEST_F(HiddenPatch, TwoIdentificationPatchesGiveTheHeading) {
  MarkerParameters parameters = teams_with(bar_layout(), 5);
  parameters.teams[1] = {};
  PaintedField field(straight_camera(), parameters);
  for (int n = 0; n < 50; ++n) {
    const Placed robot = anywhere(Team::kOwn, static_cast<std::size_t>(n % 5));
    paint(field, robot, 0.25f);
    const Comparison result = compare({robot}, field.match(), parameters);
    EXPECT_EQ(result.right, 1u) << n << " visible: " << left;
    EXPECT_LT(result.position_m, 0.006f) << n;
    EXPECT_LT(result.heading_rad, 0.15f) << n;
  }
}

TEST_F(HiddenPatch, NothingIsReportedIfTheTeamPatchIsHidden) {
  const MarkerParameters parameters = paper_teams();
  PaintedField field(straight_camera(), parameters);
  const Placed robot = anywhere(Team::kOwn, 2);
  paint(field, robot, 0.0f);
  EXPECT_TRUE(field.match().robots.empty());
  // A pixel of noise is not accepted as a partly visible patch.
  const PixelPoint team = field.camera().to_pixel(on_field(robot.pose, 0.01875f, 0.01875f), 0.075f);
  field.grid().at(static_cast<int>(team.u_px), static_cast<int>(team.v_px)) = kBlue;
  field.grid().at(static_cast<int>(team.u_px), static_cast<int>(team.v_px) + 1) = kBlue;
  EXPECT_TRUE(field.match().robots.empty());
  EXPECT_EQ(field.verdict_at(on_field(robot.pose, -0.01875f, -0.01875f), 0.075f), Verdict::kNoPartner);
}

// A partly visible patch cannot decide between two teams with the same identification colors.
TEST_F(HiddenPatch, ColorsOfBothTeamsNeedACompleteTeamPatch) {
  MarkerParameters parameters = paper_teams();
  parameters.teams[1].robots[3].colors[0] = kRed;
  PaintedField field(straight_camera(), parameters);
  paint(field, anywhere(Team::kOwn, 0), 0.25f);
  EXPECT_TRUE(field.match().robots.empty());
  paint(field, anywhere(Team::kOwn, 1), 0.25f);
  EXPECT_EQ(field.match().robots.size(), 1u);
}

// The identification patch may also belong to another, complete team patch, with a worse fit. The complete one has
// priority.
TEST_F(HiddenPatch, ACompleteTeamPatchHasPriority) {
  const MarkerParameters parameters = paper_teams();
  PaintedField field(straight_camera(), parameters);
  const Placed robot{Team::kOwn, 0, {{0.2f, 0.1f}, 0.3f}};
  paint(field, robot, 0.25f);
  field.paint_part(robot, {-0.0905f, -0.036f}, {-0.056f, -0.0015f}, kYellow);
  const Sightings& seen = field.match();
  ASSERT_EQ(seen.robots.size(), 1u);
  EXPECT_EQ(seen.robots[0].team, Team::kOpponent);
  EXPECT_EQ(seen.robots[0].id, kUnknownId);
}

TEST_F(HiddenPatch, APartlyVisibleTeamPatchAloneIsTooSmall) {
  const MarkerParameters parameters = paper_teams();
  PaintedField field(straight_camera(), parameters);
  const Placed robot{Team::kOwn, 0, {{0.2f, 0.1f}, 0.3f}};
  field.paint_part(robot, {0.01f, 0.01f}, {0.025f, 0.025f}, kBlue);
  EXPECT_TRUE(field.match().robots.empty());
  EXPECT_EQ(field.verdict_at(on_field(robot.pose, 0.0175f, 0.0175f), 0.075f), Verdict::kTooSmall);
}

// In bad light, only a spot has the color of the identification patch. With the other patches around it, that is
// enough.
TEST(DullPatch, ASpotInTheRightPlaceIsEnough) {
  const MarkerParameters parameters = teams_with(bar_layout(), 5);
  PortableRandom random(72);
  std::size_t right = 0;
  for (const CameraParameters& camera : {straight_camera(), tilted_camera()}) {
    PaintedField field(camera, parameters);
    for (int n = 0; n < 60; ++n) {
      const Placed robot{n % 2 == 0 ? Team::kOwn : Team::kOpponent,
                         static_cast<std::size_t>(n % 5),
                         {{random.real(-0.9f, 0.9f), random.real(-0.7f, 0.7f)}, random.real(-kPi, kPi)}};
      const std::size_t dull = static_cast<std::size_t>(random.whole(1, 2));
      const PatchPlace place = parameters.teams[0].layout.patches[dull];
      const ColorId color = parameters.teams[0].robots[robot.robot].colors[dull - 1];
      field.clear();
      field.paint(robot);
      field.paint_patch(robot, dull, kBackground);
      // A quarter of the patch, at a random place on it.
      const float x = place.x_m + random.real(-0.006f, 0.006f), y = place.y_m + random.real(-0.006f, 0.006f);
      field.paint_part(robot, {x - 0.008f, y - 0.008f}, {x + 0.008f, y + 0.008f}, color);
      const Comparison result = compare({robot}, field.match(), parameters);
      EXPECT_EQ(result.right + result.unknown, 1u) << n;
      EXPECT_LT(result.position_m, 0.006f) << n;
      right += result.right;
    }
  }
  // One of the five robots has the same color twice. There the spot is merged with the complete patch.
  EXPECT_GE(right, 2 * 60u * 3 / 4);
}

// If two colors have nearly the same area, the color of the patch is unknown.
TEST(DullPatch, ARivalColorGivesNoId) {
  const MarkerParameters parameters = teams_with(bar_layout(), 5);
  PaintedField field(straight_camera(), parameters);
  const Placed robot{Team::kOwn, 1, {{0.3f, -0.2f}, 2.1f}};
  const PatchPlace place = parameters.teams[0].layout.patches[2];
  field.paint(robot);
  field.paint_patch(robot, 2, kBackground);
  const auto spot = [&](float from, float to, ColorId color) {
    field.paint_part(robot, {place.x_m - 0.008f, place.y_m + from}, {place.x_m + 0.008f, place.y_m + to}, color);
  };
  spot(-0.012f, 0.004f, parameters.teams[0].robots[1].colors[1]);
  EXPECT_EQ(compare({robot}, field.match(), parameters).right, 1u);
  spot(0.004f, 0.014f, kMagenta);
  const Comparison result = compare({robot}, field.match(), parameters);
  EXPECT_EQ(result.right, 0u);
  EXPECT_EQ(result.unknown, 1u);
}

// A single identification patch has no other patches that determine its place.
TEST(DullPatch, IsNotEnoughAlone) {
  const MarkerParameters parameters = paper_teams();
  PaintedField field(straight_camera(), parameters);
  const Placed robot{Team::kOwn, 1, {{0.3f, -0.2f}, 2.1f}};
  field.paint_patch(robot, 0, kBlue);
  field.paint_part(robot, {-0.027f, -0.027f}, {-0.011f, -0.011f}, kGreen);
  const Comparison result = compare({robot}, field.match(), parameters);
  EXPECT_EQ(result.unknown, 1u);
}

}  // namespace
}  // namespace touchline::testing
