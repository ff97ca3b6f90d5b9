#include "core/marker/identifier.h"

#include <gtest/gtest.h>

#include "tests/marker/ids_from_pixels.h"

namespace touchline::testing {
namespace {

struct TeamsCase {
  const char* name;
  MarkerParameters (*teams)();
};
void PrintTo(const TeamsCase& c, std::ostream* out) { *out << c.name; }

class LongTeamPatch : public IdsFromPixels, public ::testing::WithParamInterface<TeamsCase> {};

TEST_P(LongTeamPatch, NamesRobotsOfWhichNoIdentificationRegionExists) {
  for (const PixelFormat f : {PixelFormat::kRgb24, PixelFormat::kYuyv, PixelFormat::kNv12}) {
    use(GetParam().teams(), f);
    std::size_t right = 0, robots = 0;
    for (int n = 0; n < 5; ++n) {
      boxes->clear();
      shown->clear();
      const std::vector<Placed> placed = scattered(random, parameters, 3, 1.4f, 1.2f);
      for (const Placed& robot : placed) paint_without_regions(robot);
      const Comparison result = compare(placed, look(kLampLight), parameters);
      EXPECT_EQ(result.wrong + result.ghosts, 0u) << name_of(f) << ", picture " << n;
      EXPECT_LT(result.position_m, 0.004f);
      EXPECT_LT(result.heading_rad, 0.15f);
      right += result.right;
      robots += placed.size();
      // Without pixels, only positions are reported.
      EXPECT_EQ(compare(placed, boxes->match(), parameters).right, 0u);
    }
    EXPECT_GE(right, robots * 9 / 10) << name_of(f) << " of " << robots;
  }
}

INSTANTIATE_TEST_SUITE_P(Marker, LongTeamPatch,
                         ::testing::Values(TeamsCase{"bar", [] { return teams_with(bar_layout(), 3); }},
                                           TeamsCase{"halves", [] { return teams_with(halves_layout(), 3); }},
                                           TeamsCase{"triangles", [] { return teams_with(triangles_layout(), 3); }}),
                         ::testing::PrintToStringParamName());

// A square has no axis, but around it the pixels show its identification patch.
TEST_F(IdsFromPixels, FindThePatchBesideASquareThatFellIntoNoBox) {
  for (const PixelFormat f : {PixelFormat::kRgb24, PixelFormat::kYuyv, PixelFormat::kNv12}) {
    use(teams_with(paper_teams().teams[0].layout, 3), f);
    std::size_t right = 0, robots = 0;
    for (int n = 0; n < 5; ++n) {
      boxes->clear();
      shown->clear();
      const std::vector<Placed> placed = scattered(random, parameters, 3, 1.4f, 1.2f);
      for (const Placed& robot : placed) paint_without_regions(robot);
      const Comparison result = compare(placed, look(kLampLight), parameters, 0.05f);
      EXPECT_EQ(result.wrong + result.ghosts + result.missed, 0u) << name_of(f) << ", picture " << n;
      // Only robots with a heading count.
      EXPECT_LT(result.heading_rad, 0.1f);
      right += result.right;
      robots += placed.size();
    }
    EXPECT_GE(right, robots * 9 / 10) << name_of(f) << " of " << robots;
  }
}

// The front robot's patch is as far from the rear robot's team patch as the rear robot's own patch, which fell into no
// box.
TEST_F(IdsFromPixels, FindThePatchOfARobotBehindAnotherOne) {
  use(teams_with(paper_teams().teams[0].layout, 3));
  for (const float heading : {0.0f, 0.7f, 2.9f}) {
    boxes->clear();
    shown->clear();
    const Placed front{Team::kOwn, 0, {{0.1f, 0.1f}, heading}};
    const Placed behind{
        Team::kOwn, 2, {{0.1f - 0.077f * std::cos(heading), 0.1f - 0.077f * std::sin(heading)}, heading}};
    paint(front);
    paint_without_regions(behind);
    const Comparison result = compare({front, behind}, look(kLampLight), parameters);
    EXPECT_EQ(result.right, 2u) << heading;
    EXPECT_LT(result.heading_rad, 0.1f) << heading;
  }
}

// Light that saturates a patch gives it the color of a white line. Its corner on the robot's top remains.
TEST_F(IdsFromPixels, FindThePatchThatIsMergedWithALine) {
  use(teams_with(paper_teams().teams[0].layout, 3));
  covered = painted_rgb(parameters.teams[0].robots[2].colors[0]);
  for (const float heading : {-1.9f, 0.0f, 0.3f, 2.5f}) {
    boxes->clear();
    shown->clear();
    const Placed robot{Team::kOwn, 2, {{0.0f, 0.1f}, heading}};
    paint_without_regions(robot);
    shown->paint_part(robot, {-0.08f, -0.3f}, {-0.034f, 0.3f}, kGrey);
    const Comparison result = compare({robot}, look(kLampLight), parameters);
    EXPECT_EQ(result.right, 1u) << heading;
    EXPECT_LT(result.heading_rad, 0.1f) << heading;
  }
}

// The region of the patch is in its box, but all of its pixels are saturated. A line covers two of its sides; its other
// two are visible, which is enough for a patch, but not for any saturated surface.
TEST_F(IdsFromPixels, AreKnownOfASaturatedRegionThatIsMergedWithALine) {
  use(teams_with(paper_teams().teams[0].layout, 3));
  const ColorId color = parameters.teams[0].robots[2].colors[0];
  repainted[color] = {165, 132, 140};
  covered = {200, 200, 200};
  is_blurred = true;
  set_known_colors();
  const PatchPlace& place = parameters.teams[0].layout.patches[1];
  for (const float heading : {-1.9f, 0.3f}) {
    boxes->clear();
    shown->clear();
    const Placed robot{Team::kOwn, 2, {{0.0f, 0.1f}, heading}};
    const Placed line{Team::kOwn, 2, {on_field(robot.pose, place.x_m, place.y_m), heading + 0.25f * 3.1415927f}};
    paint(robot);
    shown->paint_part(line, {-0.06f, -0.3f}, {0.0f, 0.3f}, kGrey);
    shown->paint_patch(robot, 1, color);
    const Comparison result = compare({robot}, look({2, 2, 2}), parameters);
    EXPECT_EQ(result.right, 1u) << heading;
    EXPECT_LT(result.heading_rad, 0.1f) << heading;
  }
}

// A line that goes on where a patch would end.
TEST_F(IdsFromPixels, AreNotThoseOfALine) {
  use(teams_with(paper_teams().teams[0].layout, 3));
  covered = painted_rgb(parameters.teams[0].robots[2].colors[0]);
  for (const float near : {-0.003f, -0.010f, -0.02f}) {
    boxes->clear();
    shown->clear();
    const Placed robot{Team::kOwn, 2, {{0.0f, 0.1f}, 0.3f}};
    paint_without_regions(robot);
    shown->paint_patch(robot, 1, kBackground);
    shown->paint_part(robot, {-0.08f, -0.3f}, {near, 0.3f}, kGrey);
    const Comparison result = compare({robot}, look(kLampLight), parameters, 0.05f);
    EXPECT_EQ(result.right + result.wrong, 0u) << near;
  }
}

// A robot whose identification has an unknown color is reported; a paper of the team's color is not.
TEST_F(IdsFromPixels, ReportARobotWithAnUnknownPatchButNoPaper) {
  covered = {230, 230, 230};
  for (const MarkerLayout& layout : {paper_teams().teams[0].layout, disks_layout()}) {
    use(teams_with(layout, 3));
    const std::vector<Placed> robots{kLeft, kMiddle};
    for (const Placed& robot : robots) {
      paint_without_regions(robot);
      for (std::size_t k = 1; k < layout.patches.size(); ++k) shown->paint_patch(robot, k, kGrey);
    }
    for (PaintedField* field : {boxes.get(), shown.get()}) field->paint_patch(kRight, 0, kBlue);
    const Sightings& seen = look(kLampLight);
    ASSERT_EQ(seen.robots.size(), robots.size());
    for (const RobotSighting& robot : seen.robots) {
      EXPECT_EQ(robot.id, kUnknownId);
      EXPECT_GT(robot.confidence, 0.9f);
      EXPECT_TRUE(std::any_of(robots.begin(), robots.end(), [&](const Placed& one) {
        return distance_m(robot.pose.position, one.pose.position) < 0.5f * layout.robot_side_m;
      })) << "the place of a robot";
    }
  }
}

// A shoe with stripes of the team's color has the outline of team patches and something else than floor beside them,
// but no outlines of other patches. Two stripes are nearer to each other than robots.
TEST_F(IdsFromPixels, AreLessCertainOfStripesThanOfRobots) {
  covered = {215, 215, 210};
  const MarkerLayout layout = paper_teams().teams[0].layout;
  for (const bool two : {false, true}) {
    use(teams_with(layout, 3));
    shown->paint_part(kMiddle, {-0.14f, -0.05f}, {0.14f, 0.05f}, kGrey);
    const PatchPlace& patch = layout.patches[0];
    for (const float along_m : {-0.03f, 0.03f}) {
      if (along_m > 0.0f && !two) continue;
      const FieldPoint low{along_m - 0.5f * patch.length_m, -0.5f * patch.width_m};
      const FieldPoint high{along_m + 0.5f * patch.length_m, 0.5f * patch.width_m};
      for (PaintedField* field : {boxes.get(), shown.get()}) field->paint_part(kMiddle, low, high, kBlue);
    }
    paint_without_regions(kLeft);
    shown->paint_patch(kLeft, 1, kGrey);
    const Sightings& seen = look(kLampLight);
    int robots = 0;
    for (const RobotSighting& robot : seen.robots) {
      EXPECT_EQ(robot.id, kUnknownId);
      const bool is_robot = distance_m(robot.pose.position, kLeft.pose.position) < 0.5f * layout.robot_side_m;
      robots += is_robot ? 1 : 0;
      if (is_robot) {
        EXPECT_GT(robot.confidence, 0.9f);
      } else {
        EXPECT_LT(robot.confidence, two ? 0.45f : 0.8f);
      }
    }
    EXPECT_EQ(robots, 1);
  }
}

// Under another lamp, a quarter of the team patch is in its box.
TEST_F(IdsFromPixels, FindARobotByAPartOfItsTeamPatch) {
  for (const auto& layout : {bar_layout(), halves_layout(), triangles_layout()}) {
    use(teams_with(layout, 3));
    for (const Placed& robot : {kLeft, kMiddle, kRight}) {
      shown->paint(robot);
      const PatchPlace& patch = layout.patches[0];
      boxes->paint_part(robot, {patch.x_m - 0.009f, patch.y_m - 0.012f}, {patch.x_m + 0.009f, patch.y_m + 0.008f},
                        kBlue);
    }
    const Comparison result = compare({kLeft, kMiddle, kRight}, look(kLampLight), parameters);
    EXPECT_EQ(result.right, 3u);
    EXPECT_LT(result.position_m, 0.005f);
    EXPECT_LT(result.heading_rad, 0.2f);
    EXPECT_EQ(boxes->match().robots.size(), 0u);
  }
}

TEST_F(IdsFromPixels, ReportNoRobotWhereASpeckHasTheTeamColor) {
  use(teams_with(bar_layout(), 3));
  paint(kLeft);
  // One patch beside a robot, one alone, and one as large as a team patch that is half hidden.
  const Placed beside{Team::kOwn, 0, {{-0.3f, 0.16f}, 0.3f}}, alone{Team::kOwn, 0, {{0.2f, -0.2f}, 0.3f}},
      large{Team::kOwn, 0, {{0.4f, 0.3f}, 1.3f}};
  for (PaintedField* field : {boxes.get(), shown.get()}) {
    field->paint_part(beside, {-0.007f, -0.007f}, {0.007f, 0.007f}, kBlue);
    field->paint_part(alone, {-0.01f, -0.01f}, {0.01f, 0.01f}, kBlue);
    field->paint_part(large, {-0.012f, -0.02f}, {0.012f, 0.02f}, kBlue);
  }
  const Comparison result = compare({kLeft}, look(), parameters);
  EXPECT_EQ(result.right, 1u);
  EXPECT_EQ(result.ghosts, 0u);
}

TEST_F(IdsFromPixels, CorrectAWrongBox) {
  use(teams_with(halves_layout(), 3));  // red, green, magenta
  paint(kLeft);
  paint(kMiddle);
  // Under this lamp, the magenta patch fell into the box of red.
  shown->paint(kRight);
  boxes->paint(kRight);
  boxes->paint_patch(kRight, 1, kRed);
  const Sightings& seen = look(kLampLight);
  const Comparison result = compare({kLeft, kMiddle, kRight}, seen, parameters);
  EXPECT_EQ(result.right, 3u);
  // The region of the wrong color is not reported as a patch of this robot.
  for (const RobotSighting& robot : seen.robots) EXPECT_EQ(robot.patches.size(), robot.id == 2 ? 1u : 2u);
  EXPECT_LT(compare({kLeft, kMiddle, kRight}, boxes->match(), parameters).right, 3u);
}

// A lamp's reflection brightens the dark channels of a patch, and the camera saturates at 218.
TEST_F(IdsFromPixels, AreKnownOfPatchesThatMirrorALamp) {
  for (const auto& layout : {bar_layout(), halves_layout()}) {
    MarkerParameters teams = teams_with(layout, 3);
    teams.teams[0].robots[1].colors[0] = kViolet;
    use(teams);
    for (const double glare : {0.05, 0.1, 0.15}) {
      boxes->clear();
      shown->clear();
      for (const Placed& robot : {kLeft, kMiddle, kRight}) paint(robot);
      shown->paint_patch(kMiddle, 1, kGrey);
      for (std::size_t c = 0; c < 3; ++c) {
        const double value = painted_rgb(kViolet)[c];
        covered[c] = std::min(218.0, std::sqrt(value * value + glare * 255.0 * 255.0));
      }
      EXPECT_EQ(compare({kLeft, kMiddle, kRight}, look(), parameters).right, 3u) << glare;
    }
  }
}

// Values that were clipped and then darkened end below 255. Only the borders of the patches, which show how bright the
// clipped channels really are, distinguish pink from lavender.
TEST_F(IdsFromPixels, AreKnownOfPatchesThatWereClippedBeforeTheyWereDarkened) {
  MarkerParameters teams = teams_with(halves_layout(), 3);
  teams.teams[0].robots[1].colors[0] = kMagenta;
  teams.teams[0].robots[2].colors[0] = kViolet;
  use(teams);
  repainted[kMagenta] = {250, 187, 199};
  repainted[kViolet] = {205, 200, 244};
  set_known_colors();
  is_blurred = true;
  clipped_at = 180;
  for (const bool exchanged : {false, true}) {
    boxes->clear();
    shown->clear();
    Placed one = kMiddle, other = kRight;
    if (exchanged) std::swap(one.robot, other.robot);
    paint(kLeft);
    paint_without_regions(one);
    paint_without_regions(other);
    EXPECT_EQ(compare({kLeft, one, other}, look(), parameters).right, 3u);
  }
}

// Motion blur leaves a fifth of the identification patch and half of the team patch in their boxes. An object of the
// team's color touches the team patch, so its pixels alone do not show where it ends.
TEST_F(IdsFromPixels, FindARobotByPartsOfItsPatches) {
  use(teams_with(halves_layout(), 3));
  const PatchPlace &team = parameters.teams[0].layout.patches[0], &id = parameters.teams[0].layout.patches[1];
  for (const Placed& robot : {kLeft, kMiddle, kRight}) {
    shown->paint(robot);
    shown->paint_part(robot, {0.015f, team.y_m}, {0.03f, team.y_m + 0.05f}, kBlue);
    boxes->paint_part(robot, {-0.026f, team.y_m - 0.012f}, {0.026f, team.y_m + 0.012f}, kBlue);
    boxes->paint_part(robot, {-0.016f, id.y_m - 0.008f}, {0.016f, id.y_m + 0.008f},
                      parameters.teams[0].robots[robot.robot].colors[0]);
  }
  const Comparison result = compare({kLeft, kMiddle, kRight}, look(kLampLight), parameters);
  EXPECT_EQ(result.right, 3u);
  EXPECT_LT(result.position_m, 0.006f);
  EXPECT_LT(result.heading_rad, 0.2f);
}

// A part of another robot's color beside a team patch gives no id, because the pixels around it are not those of a
// patch.
TEST_F(IdsFromPixels, AreNotToldByASpeckWhereNoPatchIs) {
  use(teams_with(halves_layout(), 3));
  const PatchPlace& id = parameters.teams[0].layout.patches[1];
  for (const Placed& robot : {kLeft, kMiddle, kRight}) {
    for (PaintedField* field : {boxes.get(), shown.get()}) {
      field->paint_patch(robot, 0, kBlue);
      field->paint_part(robot, {-0.004f, id.y_m - 0.01f}, {0.004f, id.y_m + 0.01f}, kMagenta);
    }
  }
  EXPECT_EQ(compare({kLeft, kMiddle, kRight}, look(kLampLight), parameters).wrong, 0u);
}

// Ids of a butterfly differ in which dots have which of two colors.
TEST_F(IdsFromPixels, NamesAButterflyOfWhichDotsAreMissing) {
  MarkerParameters teams = teams_with(disks_layout(), 6);
  for (TeamMarking& team : teams.teams) {
    for (std::size_t r = 0; r < team.robots.size(); ++r) {
      for (std::size_t s = 0; s < 4; ++s) team.robots[r].colors[s] = ((r * 5 + 3) >> s & 1u) != 0 ? kMagenta : kGreen;
    }
  }
  use(teams);
  std::size_t right = 0, robots = 0;
  for (int n = 0; n < 8; ++n) {
    boxes->clear();
    shown->clear();
    const std::vector<Placed> placed = scattered(random, parameters, 6, 2.0f, 1.6f);
    for (const Placed& robot : placed) {
      paint(robot);
      // Two dots fall into no box; one of them is half covered by something dark.
      const auto first = static_cast<std::size_t>(random.whole(1, 4));
      const std::size_t second = first % 4 + 1;
      boxes->paint_patch(robot, first, kBackground);
      boxes->paint_patch(robot, second, kBackground);
      const PatchPlace& dot = teams.teams[0].layout.patches[second];
      shown->paint_part(robot, {dot.x_m + 0.006f, dot.y_m - 0.02f}, {dot.x_m + 0.02f, dot.y_m + 0.02f}, kBackground);
    }
    const Comparison result = compare(placed, look(kLampLight), parameters, 0.08f);
    EXPECT_EQ(result.wrong, 0u) << "picture " << n;
    right += result.right;
    robots += placed.size();
  }
  EXPECT_GE(right, robots * 9 / 10) << "of " << robots;
}

}  // namespace
}  // namespace touchline::testing
