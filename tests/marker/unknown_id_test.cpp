// Tests robots whose pixels do not decide their id: such a robot gets no id, and its confidence is the probability that
// it is a robot.
#include <gtest/gtest.h>

#include "tests/marker/ids_from_pixels.h"

namespace touchline::testing {
namespace {

TEST_F(IdsFromPixels, IsUnknownIfTheRatioFitsTwoRobots) {
  MarkerParameters teams = teams_with(halves_layout(), 2);
  teams.teams[0].robots[0].colors[0] = kRed;
  teams.teams[0].robots[1].colors[0] = kPink;
  use(teams);
  paint_without_regions(kLeft);
  const Sightings& seen = look(kLampLight);
  ASSERT_EQ(seen.robots.size(), 1u);
  EXPECT_EQ(seen.robots[0].id, kUnknownId);
  EXPECT_TRUE(seen.robots[0].has_heading);  // the heading is the same for both possible robots
}

TEST_F(IdsFromPixels, IsNeverWrongIfThePatchIsCovered) {
  for (const auto& layout :
       {bar_layout(), halves_layout(), triangles_layout(), paper_teams().teams[0].layout, disks_layout()}) {
    use(teams_with(layout, 3));
    // A robot's dark top, a hand, paper, and a color of no robot.
    for (const Rgb cover : {Rgb{20, 20, 22}, Rgb{190, 140, 110}, Rgb{230, 230, 225}, Rgb{70, 150, 160}}) {
      for (const bool has_others : {false, true}) {
        boxes->clear();
        shown->clear();
        if (has_others) {
          paint(kLeft);
          paint(kMiddle);
        }
        paint_without_regions(kRight);
        for (std::size_t k = 1; k < layout.patches.size(); ++k) shown->paint_patch(kRight, k, kGrey);
        covered = cover;
        const Comparison result = compare({kLeft, kMiddle, kRight}, look(), parameters);
        EXPECT_EQ(result.right, has_others ? 2u : 0u);
        EXPECT_EQ(result.wrong, 0u);
        EXPECT_EQ(result.unknown, 1u);
      }
    }
  }
}

// Objects of a team's color and of an identification color lie on the floor; boxes contain a part of the first and a
// whole patch of the second. Beside them is floor, not the top of a robot.
TEST_F(IdsFromPixels, WithoutAHeadingNeedTheShapeOfARobot) {
  use(paper_teams());
  const MarkerLayout& layout = parameters.teams[0].layout;
  const FieldPoint team{layout.patches[0].x_m, layout.patches[0].y_m};
  const float half = 0.5f * layout.patches[0].length_m;
  const auto paint_both = [&](const Placed& robot, float sheet_m) {
    boxes->clear();
    shown->clear();
    for (PaintedField* field : {boxes.get(), shown.get()}) field->paint_patch(robot, 1, kRed);
    // The boxes see a strip at the edge that is next to the robot's center.
    boxes->paint_part(robot, {team.x_m - half, team.y_m - half}, {team.x_m + half, team.y_m - 0.6f * half}, kBlue);
    shown->paint_part(robot, {team.x_m - half, team.y_m - half}, {team.x_m - half + sheet_m, team.y_m - half + sheet_m},
                      kBlue);
  };
  for (const float sheet_m : {0.25f * half, 0.1f, 0.2f}) {
    paint_both(kLeft, sheet_m);
    for (const RobotSighting& robot : look().robots) {
      EXPECT_EQ(robot.id, kUnknownId) << sheet_m << ", confidence " << robot.confidence << ", heading "
                                      << robot.has_heading;
    }
  }
}

// An overload left as much of a sheet of the team's color as a team patch has. The pixels show the whole sheet.
TEST_F(IdsFromPixels, NeedOutlinesIfAnOverloadCutThePatches) {
  use(paper_teams());
  for (const bool is_sheet : {false, true}) {
    for (const bool is_cut : {false, true}) {
      boxes->clear();
      shown->clear();
      boxes->set_cut(is_cut);
      if (is_sheet) shown->paint_part(kLeft, {0.0f, 0.0f}, {0.2f, 0.2f}, kBlue);
      paint(kLeft);
      const Sightings& seen = look();
      ASSERT_EQ(seen.robots.size(), 1u);
      EXPECT_EQ(seen.robots[0].id, is_sheet && is_cut ? kUnknownId : RobotId{0}) << is_sheet << is_cut;
      EXPECT_EQ(seen.robots[0].doubt, is_sheet && is_cut ? IdDoubt::kOverload : IdDoubt::kNone);
    }
  }
  // Without a frame, nothing shows outlines.
  EXPECT_EQ(boxes->match().robots[0].id, kUnknownId);
}

// Two stripes of a shoe look like a robot: the first has the team's color, and the pixels of the second are as near to
// an identification color as to the team's color.
TEST_F(IdsFromPixels, AreUnknownIfAPatchHasTheColorOfTheTeam) {
  use(teams_with(paper_teams().teams[0].layout, 3));
  const ColorId color = parameters.teams[0].robots[0].colors[0];
  repainted[color] = {60, 112, 200};
  set_known_colors();
  for (const bool is_shoe : {false, true}) {
    boxes->clear();
    shown->clear();
    paint_without_regions(kLeft);
    if (is_shoe) shown->paint_patch(kLeft, 1, kBlue);
    const Comparison result = compare({kLeft}, look(kLampLight), parameters);
    EXPECT_EQ(result.right, is_shoe ? 0u : 1u);
    EXPECT_EQ(result.wrong, 0u);
  }
}

// One of the robot's two colors fits a robot of the team.
TEST_F(IdsFromPixels, AreUnknownForARobotThatIsNotInTheTeamFile) {
  use(teams_with(bar_layout(), 2));  // red and green, green and green
  paint(kLeft);
  paint(kMiddle);
  for (PaintedField* field : {boxes.get(), shown.get()}) field->paint_patch(kMiddle, 1, kMagenta);
  const Sightings& seen = look();
  ASSERT_EQ(seen.robots.size(), 2u);
  for (const RobotSighting& robot : seen.robots) {
    EXPECT_EQ(robot.id, robot.pose.position.x_m < -0.1f ? 0 : kUnknownId);
  }
}

TEST_F(IdsFromPixels, NamesNoTwoRobotsAlike) {
  use(teams_with(halves_layout(), 3));
  const Placed twin{Team::kOwn, 0, kRight.pose};
  paint(kLeft);
  paint(twin);
  paint(kMiddle);
  const Sightings& seen = look();
  ASSERT_EQ(seen.robots.size(), 3u);
  std::size_t named = 0;
  for (const RobotSighting& robot : seen.robots) {
    if (robot.id == kUnknownId) continue;
    ++named;
    EXPECT_EQ(robot.id, 1);
  }
  EXPECT_EQ(named, 1u);
}

TEST_F(IdsFromPixels, TheOthersOfTheTeamDecideADoubtfulId) {
  MarkerParameters teams = teams_with(halves_layout(), 2);
  teams.teams[0].robots[0].colors[0] = kRed;
  teams.teams[0].robots[1].colors[0] = kLime;
  use(teams);
  // A color halfway between red and lime alone fits either of the two robots.
  paint_without_regions(kMiddle);
  shown->paint_patch(kMiddle, 1, kGrey);
  for (std::size_t c = 0; c < 3; ++c) covered[c] = 0.5 * (painted_rgb(kRed)[c] + painted_rgb(kLime)[c]);
  const Sightings& alone = look();
  ASSERT_EQ(alone.robots.size(), 1u);
  EXPECT_EQ(alone.robots[0].id, kUnknownId);
  EXPECT_TRUE(alone.robots[0].has_heading);
  // If the red one is elsewhere, only one name is left.
  paint(kLeft);
  EXPECT_EQ(compare({kLeft, kMiddle}, look(), parameters).right, 2u);
}

TEST_F(IdsFromPixels, TheMarginIsTheConfidence) {
  use(teams_with(halves_layout(), 2));  // red, green
  float former = 1.0f;
  float least = 1.0f;
  // From the typical red towards green.
  for (const double part : {0.0, 0.1, 0.2, 0.3, 0.4}) {
    boxes->clear();
    shown->clear();
    paint_without_regions(kLeft);
    shown->paint_patch(kLeft, 1, kGrey);
    for (std::size_t c = 0; c < 3; ++c) covered[c] = (1 - part) * painted_rgb(kRed)[c] + part * painted_rgb(kGreen)[c];
    const Sightings& seen = look({1, 1, 1}, 0);
    ASSERT_EQ(seen.robots.size(), 1u);
    if (part == 0.0) {
      EXPECT_EQ(seen.robots[0].id, 0);
      EXPECT_GT(seen.robots[0].confidence, 0.9f);
    }
    EXPECT_NE(seen.robots[0].id, 1);
    if (seen.robots[0].id == kUnknownId) break;
    EXPECT_LE(seen.robots[0].confidence, former + 1e-4f);
    former = seen.robots[0].confidence;
    least = std::min(least, former);
  }
  EXPECT_GT(least, 0.8f);
}

TEST_F(IdsFromPixels, AreThoseOfTheBoxesWithoutTypicalColors) {
  use(teams_with(bar_layout(), 3));
  TypicalColors typical = typical_colors(ColorSpace::kRgb);
  typical.measured[kGreen] = false;
  boxes->set_typical_colors(typical);
  paint(kLeft);
  paint_without_regions(kMiddle);
  const Comparison result = compare({kLeft, kMiddle}, look(), parameters);
  EXPECT_EQ(result.right, 1u);
  EXPECT_EQ(result.unknown, 1u);
}

}  // namespace
}  // namespace touchline::testing
