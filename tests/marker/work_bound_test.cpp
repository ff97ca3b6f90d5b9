#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <memory>

#include "tests/marker/ids_from_pixels.h"
#include "tests/marker/real_layouts.h"
#include "tests/marker/region_list.h"

// Tests the matcher's bounds of work, which frames of the largest teams never reach.
namespace touchline::testing {
namespace {

constexpr std::size_t kRobots = 11;

// Six squares of 20 mm in two columns.
MarkerLayout six_patches() {
  MarkerLayout layout = paper_layout();
  layout.patches.clear();
  for (int i = 0; i < 6; ++i) {
    const PatchRole role = i == 0 ? PatchRole::kTeam : PatchRole::kIdentification;
    layout.patches.push_back({role, PatchOutline::kSquare, 0.024f * static_cast<float>(1 - i / 2),
                              i % 2 == 0 ? 0.014f : -0.014f, 0.02f, 0.02f});
  }
  return layout;
}

// Robot r has color r + s * (1 + r / 10) in slot s: eleven sequences of ten colors.
MarkerParameters largest_teams() {
  MarkerParameters parameters = teams_with(six_patches(), kRobots);
  constexpr std::array<ColorId, 10> kColors{kRed,  kGreen, kMagenta, kCyan, kViolet,
                                            kPink, kLime,  kBrown,   kGrey, kWhite};
  for (TeamMarking& team : parameters.teams) {
    for (std::size_t r = 0; r < kRobots; ++r) {
      for (std::size_t s = 0; s < 5; ++s) team.robots[r].colors[s] = kColors[(r + s * (1 + r / 10)) % kColors.size()];
    }
  }
  return parameters;
}

void expect_complete(const MarkerParameters& parameters, float length_m, float width_m) {
  PaintedField field(straight_camera(), parameters);
  PortableRandom random(11);
  for (int n = 0; n < 20; ++n) {
    field.clear();
    field.paint(scattered(random, parameters, kRobots, length_m, width_m));
    const Sightings& seen = field.match();
    EXPECT_FALSE(seen.cut_short) << length_m << " x " << width_m << ", " << n;
    EXPECT_EQ(seen.robots.size(), 2 * kRobots) << length_m << " x " << width_m << ", " << n;
  }
}

TEST(WorkBound, LargestTeamsAreSearchedCompletely) {
  for (const MarkerParameters& parameters : {largest_teams(), teams_with(six_patches(), kRobots)}) {
    expect_complete(parameters, 2.0f, 1.6f);
    expect_complete(parameters, 0.75f, 0.6f);
  }
}

// Every team patch gets its share of the work, and the overload is reported.
TEST(WorkBound, AFieldFullOfPatchesIsCutShort) {
  const MarkerParameters parameters = largest_teams();
  RegionList list(straight_camera(), parameters);
  const TeamMarking& team = parameters.teams[0];
  const PatchPlace& patch = team.layout.patches[0];
  std::size_t n = 0;
  for (int row = 0; row < 20; ++row) {
    for (int column = 0; column < 20; ++column, ++n) {
      const ColorId color = n % 7 == 0 ? parameters.teams[n % 2].team_color : team.robots[n % kRobots].colors[n % 5];
      list.add({0.022f * static_cast<float>(column - 10), 0.022f * static_cast<float>(row - 10)}, color, patch,
               team.layout.height_m);
    }
  }
  EXPECT_TRUE(list.match().cut_short);
}

// Team patches of 35 mm and one identification patch each, of three colors.
MarkerParameters small_teams(std::uint8_t robots) {
  MarkerParameters parameters = teams_with(paper_layout(), 3);
  for (TeamMarking& team : parameters.teams) team.max_robots = robots;
  return parameters;
}

// Four patches that touch one another, in a column of the picture.
void paint_column(PaintedField& field, FieldPoint at, ColorId color) {
  constexpr float kHalf = 0.01725f;
  field.paint_part({Team::kOwn, 0, {at, 0.0f}}, {-kHalf, -4 * kHalf}, {kHalf, 4 * kHalf}, color);
}

TEST(WorkBound, SplittingDependsOnTheRobotsOfTheTeams) {
  for (const std::uint8_t robots : {std::uint8_t{3}, std::uint8_t{11}}) {
    PaintedField field(straight_camera(), small_teams(robots));
    constexpr std::array<ColorId, 3> kColors{kRed, kGreen, kMagenta};
    for (int i = 0; i < 36; ++i) {
      paint_column(field, {0.15f * static_cast<float>(i % 12) - 0.8f, 0.4f * static_cast<float>(i / 12) - 0.4f},
                   kColors[static_cast<std::size_t>(i / 12)]);
    }
    const Sightings& seen = field.match();
    ASSERT_EQ(field.regions().size(), 36u);
    EXPECT_EQ(seen.cut_short, robots == 3);
    const auto surplus = std::count(seen.verdicts.begin(), seen.verdicts.begin() + 36, Verdict::kSurplus);
    EXPECT_EQ(surplus > 0, robots == 3) << surplus;
    EXPECT_LT(surplus, 36);
  }
}

TEST(WorkBound, EveryColorMayHaveARegionOfFourPatches) {
  PaintedField field(straight_camera(), small_teams(1));
  float x = -0.6f;
  for (const ColorId color : {kBlue, kYellow, kRed, kGreen, kMagenta}) paint_column(field, {x += 0.2f, 0.0f}, color);
  EXPECT_FALSE(field.match().cut_short);
  EXPECT_EQ(field.regions().size(), 5u);
}

TEST(WorkBound, EveryClaimantHasAnEqualShareOfWhatIsLeft) {
  WorkBudget<int> budget(12, 4);
  EXPECT_EQ(budget.take(), 3);
  EXPECT_EQ(budget.take(2), 6);  // two claimants at once
  budget.give_back(5);
  EXPECT_EQ(budget.take(), 8);
  budget.give_back(-1);  // used more than its share
  EXPECT_EQ(budget.left(), -1);
  EXPECT_EQ(budget.take(), 0);  // a claimant that was not announced
}

TEST(WorkBound, WorkThatIsNotNeededIsLeftToOthers) {
  const MarkerParameters parameters = paper_teams();
  std::array<TeamPatch, 4> patches{};
  const PatchLists lists{patches, {}};
  WorkBudget<int> work(100, patches.size());
  const auto hypotheses = std::make_unique<Hypotheses>();
  for (std::size_t i = 0; i < patches.size(); ++i) {
    EXPECT_TRUE(add_hypotheses(parameters.teams, lists, i, work, *hypotheses));
  }
  EXPECT_EQ(work.left(), 100);
}

// Eleven objects of the own team's color, with four white dots each, come first in the order. All dots are saturated,
// so only their borders show their colors.
TEST_F(IdsFromPixels, AreKnownOfSaturatedPatchesBehindClutter) {
  MarkerParameters teams = teams_with(disks_layout(), 6);
  teams.teams[0].robots.resize(3);
  for (TeamMarking& team : teams.teams) team.max_robots = kRobots;
  use(teams);
  repainted = {
      {kYellow, {110, 95, 20}}, {kRed, {220, 130, 130}}, {kGreen, {130, 220, 130}}, {kMagenta, {130, 130, 220}}};
  covered = {200, 200, 200};
  is_blurred = true;
  set_known_colors();
  for (const std::size_t things : {std::size_t{0}, kRobots}) {
    boxes->clear();
    shown->clear();
    for (std::size_t i = 0; i < things; ++i) {
      const Placed thing{Team::kOwn, 0, {{0.25f * static_cast<float>(i % 6) - 0.7f, i < 6 ? 0.5f : 0.1f}, 0.0f}};
      paint_without_regions(thing);
      for (std::size_t k = 1; k <= 4; ++k) shown->paint_patch(thing, k, kGrey);
    }
    std::vector<Placed> robots;
    for (std::size_t r = 0; r < 6; ++r) {
      robots.push_back({Team::kOpponent, r, {{0.25f * static_cast<float>(r) - 0.7f, -0.4f}, static_cast<float>(r)}});
    }
    for (const Placed& robot : robots) paint(robot);
    const Comparison result = compare(robots, look({2, 2, 2}), parameters);
    EXPECT_EQ(result.right, robots.size()) << things;
    EXPECT_EQ(result.wrong, 0u) << things;
  }
}

}  // namespace
}  // namespace touchline::testing
