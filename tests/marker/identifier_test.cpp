#include "core/marker/identifier.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "tests/color/owned_picture.h"
#include "tests/color/rgb_to_yuv.h"
#include "tests/marker/real_layouts.h"

// Ids from the pixels of a frame. The color boxes see one picture (`boxes`), the camera another one (`shown`): a patch
// that fell into no box is missing only in the first.
namespace touchline::testing {
namespace {

using Rgb = std::array<double, 3>;

constexpr Rgb kFloorColor{40, 42, 40};

Rgb rgb_of(ColorId color) {
  switch (color) {
    case kBlue:
      return {50, 90, 200};
    case kYellow:
      return {200, 180, 30};
    case kOrange:
      return {220, 100, 30};
    case kRed:
      return {160, 50, 45};
    case kGreen:
      return {60, 130, 55};
    case kMagenta:
      return {150, 60, 140};
    case kCyan:
      return {70, 150, 160};
    case kViolet:
      return {110, 5, 190};
    case kPink:
      return {165, 52, 48};  // hardly different from red
    case kLime:
      return {120, 85, 50};
    default:
      return kFloorColor;
  }
}

Channels encoded(const Rgb& rgb, ColorSpace space) {
  const auto byte = [](double x) { return static_cast<std::uint8_t>(std::lround(std::clamp(x, 0.0, 255.0))); };
  const std::array<double, 3> value = in_space(space, rgb);
  return {byte(value[0]), byte(value[1]), byte(value[2])};
}

TypicalColors typical_colors(ColorSpace space) {
  TypicalColors typical;
  for (ColorId color = kBlue; color <= kLime; ++color) {
    typical[color] = encoded(rgb_of(color), space);
    typical.measured[color] = true;
  }
  return typical;
}

class IdsFromPixels : public ::testing::Test {
 protected:
  void use(const MarkerParameters& teams, PixelFormat pixel_format = PixelFormat::kRgb24) {
    parameters = teams;
    format = pixel_format;
    boxes = std::make_unique<PaintedField>(straight_camera(), teams);
    shown = std::make_unique<PaintedField>(straight_camera(), teams);
    boxes->set_typical_colors(typical_colors(color_space(format)));
  }
  void paint(const Placed& robot) {
    boxes->paint(robot);
    shown->paint(robot);
  }
  // A robot whose team patch alone falls into its box.
  void paint_without_regions(const Placed& robot) {
    shown->paint(robot);
    boxes->paint_patch(robot, 0, parameters.teams[static_cast<std::size_t>(robot.team)].team_color);
  }
  // Patches painted grey have the color `covered`.
  const Sightings& look(const Rgb& light = {1, 1, 1}, int noise = 3) {
    OwnedPicture picture(format, 640, 480, 0);
    for (int v = 0; v < 480; ++v) {
      for (int u = 0; u < 640; ++u) {
        const ColorId color = shown->grid().at(u, v);
        Rgb rgb = color == kGrey ? covered : rgb_of(color);
        for (std::size_t c = 0; c < 3; ++c) rgb[c] = light[c] * rgb[c] + random.whole(-noise, noise);
        picture.set(u, v, encoded(rgb, color_space(format)));
      }
    }
    const Frame frame = picture.frame();
    return boxes->match(&frame);
  }

  MarkerParameters parameters;
  PixelFormat format = PixelFormat::kRgb24;
  Rgb covered{};
  std::unique_ptr<PaintedField> boxes, shown;
  PortableRandom random{17};
};

constexpr Rgb kLampLight{0.75, 0.6, 0.45};

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
      // Without pixels there are only positions.
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

const Placed kLeft{Team::kOwn, 0, {{-0.3f, 0.1f}, 0.4f}}, kMiddle{Team::kOwn, 1, {{0.0f, 0.1f}, -1.9f}},
    kRight{Team::kOwn, 2, {{0.3f, 0.1f}, 2.6f}};

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
      // Only those with a heading count.
      EXPECT_LT(result.heading_rad, 0.1f);
      right += result.right;
      robots += placed.size();
    }
    EXPECT_GE(right, robots * 9 / 10) << name_of(f) << " of " << robots;
  }
}

// Its place is reported if the pixels around it show nothing.
TEST_F(IdsFromPixels, ReportThePlaceOfASquareOrDiskWithoutIdentification) {
  for (const MarkerLayout& layout : {paper_teams().teams[0].layout, disks_layout()}) {
    use(teams_with(layout, 3));
    const std::vector<Placed> placed{kLeft, kMiddle, kRight};
    for (const Placed& robot : placed) {
      for (PaintedField* field : {boxes.get(), shown.get()}) field->paint_patch(robot, 0, kBlue);
    }
    const Sightings& seen = look(kLampLight);
    ASSERT_EQ(seen.robots.size(), placed.size());
    for (const RobotSighting& robot : seen.robots) {
      EXPECT_EQ(robot.id, kUnknownId);
      EXPECT_FALSE(robot.has_heading);
      EXPECT_GT(robot.confidence, 0.5f);
      EXPECT_TRUE(std::any_of(placed.begin(), placed.end(), [&](const Placed& one) {
        const PatchPlace& patch = layout.patches[0];
        return distance_m(robot.pose.position, on_field(one.pose, patch.x_m, patch.y_m)) < 0.003f;
      })) << "the place of a team patch";
    }
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
  // One beside a robot, one alone, one as large as a team patch that is half hidden.
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
        const double value = rgb_of(kViolet)[c];
        covered[c] = std::min(218.0, std::sqrt(value * value + glare * 255.0 * 255.0));
      }
      EXPECT_EQ(compare({kLeft, kMiddle, kRight}, look(), parameters).right, 3u) << glare;
    }
  }
}

TEST_F(IdsFromPixels, IsUnknownIfTheRatioFitsTwoRobots) {
  MarkerParameters teams = teams_with(halves_layout(), 2);
  teams.teams[0].robots[0].colors[0] = kRed;
  teams.teams[0].robots[1].colors[0] = kPink;
  use(teams);
  paint_without_regions(kLeft);
  const Sightings& seen = look(kLampLight);
  ASSERT_EQ(seen.robots.size(), 1u);
  EXPECT_EQ(seen.robots[0].id, kUnknownId);
  EXPECT_TRUE(seen.robots[0].has_heading);  // whichever of both it is
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

// One of its two colors fits a robot of the team.
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
  // Halfway between red and lime, a robot alone may be either of the two.
  paint_without_regions(kMiddle);
  shown->paint_patch(kMiddle, 1, kGrey);
  for (std::size_t c = 0; c < 3; ++c) covered[c] = 0.5 * (rgb_of(kRed)[c] + rgb_of(kLime)[c]);
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
    for (std::size_t c = 0; c < 3; ++c) covered[c] = (1 - part) * rgb_of(kRed)[c] + part * rgb_of(kGreen)[c];
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
