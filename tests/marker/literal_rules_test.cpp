#include "tests/marker/literal_rules.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/geometry/angle.h"
#include "tests/marker/region_list.h"

// Compares the matcher with the paper's rules, applied literally, on random arrangements of the paper's layout.
namespace touchline::testing {
namespace {

using literal::Pair;

literal::Table table_of(std::vector<std::vector<bool>> entries) {
  literal::Table table;
  table.entry = std::move(entries);
  for (std::size_t r = 0; r < table.entry.size(); ++r) table.rows.push_back(r);
  for (std::size_t c = 0; c < table.entry.front().size(); ++c) table.columns.push_back(c);
  return table;
}

// Table 1 as printed, and the pairs that the text derives from it (rows 1 to 3, columns A to C).
TEST(LiteralRules, SolveTheTablesOfThePaper) {
  const auto a = solve(table_of({{false, false, true}, {true, false, false}, {false, true, false}}));
  EXPECT_TRUE(a.unambiguous);
  EXPECT_EQ(a.pairs, (std::vector<Pair>{{0, 2}, {1, 0}, {2, 1}}));
  const auto b = solve(table_of({{false, false, true}, {false, true, true}, {true, false, true}}));
  EXPECT_TRUE(b.unambiguous);
  EXPECT_EQ(b.pairs, (std::vector<Pair>{{0, 2}, {1, 1}, {2, 0}}));
  const auto c = solve(table_of({{false, true, true}, {true, true, false}, {true, false, false}}));
  EXPECT_TRUE(c.unambiguous);
  EXPECT_EQ(c.pairs, (std::vector<Pair>{{0, 2}, {1, 1}, {2, 0}}));
}

TEST(LiteralRules, KnowWhereTheTextLeavesAChoice) {
  EXPECT_FALSE(solve(table_of({{true, true}, {true, true}})).unambiguous);    // nothing is single
  EXPECT_FALSE(solve(table_of({{true, false}, {true, false}})).unambiguous);  // one column for two rows
  EXPECT_FALSE(solve(table_of({{true, false}, {false, false}})).unambiguous);
}

TEST(LiteralRules, ConditionsOneAndTwo) {
  const std::vector<literal::Region> regions{
      {kBlue, {0.0f, 0.0f}, 100},   {kBlue, {0.0258f, 0.0f}, 90},  // closer than 25.9 mm: rejected by eq. (1)
      {kBlue, {0.0f, 0.0260f}, 80}, {kBlue, {0.5f, 0.5f}, 3},      // D of figure 5: not among the largest
      {kRed, {0.0f, -0.0740f}, 70}, {kGreen, {0.0f, -0.0265f}, 60}, {kGreen, {0.2f, 0.2f}, 2}};
  const literal::Table table = literal::make_table(regions, kBlue, {kRed, kGreen});
  EXPECT_EQ(table.columns, (std::vector<std::size_t>{0, 2}));
  EXPECT_EQ(table.rows, (std::vector<std::size_t>{4, 5}));
  EXPECT_EQ(table.entry, (std::vector<std::vector<bool>>{{true, false}, {true, true}}));
  const FieldPoint refined = literal::refined(regions, 0);
  EXPECT_NEAR(refined.x_m, 0.0258f * 90 / 270, 1e-6f);
  EXPECT_NEAR(refined.y_m, 0.0260f * 80 / 270, 1e-6f);
}

std::size_t patches_near(FieldPoint at, ColorId color, const RegionList& list) {
  constexpr float kHeight = 0.075f, kNear = 0.036f;
  return static_cast<std::size_t>(
      std::count_if(list.regions().begin(), list.regions().end(), [&](const Region& region) {
        return region.color == color && distance_m(list.camera().to_field(region.centroid, kHeight), at) < kNear;
      }));
}

// Results of one team's arrangement, by the rules and by the matcher.
struct Tally {
  int robots = 0, unambiguous = 0, sure = 0, contested = 0;
};

void compare_with_matcher(const MarkerParameters& parameters, float side_m, float error_m, std::uint32_t seed,
                          int arrangements, Tally& tally) {
  RegionList list(straight_camera(), parameters);
  PortableRandom random(seed);
  for (int n = 0; n < arrangements; ++n) {
    list.clear();
    const std::vector<Placed> placed = scattered(random, parameters, 5, side_m, side_m);
    for (const Placed& robot : placed) list.add(robot, random, error_m);
    // Regions 4 and D of figure 5. None is near two patches of its color: by the text it would be averaged with both.
    for (int color = kBlue + random.whole(0, 1); color <= kWhite; color += 2) {
      const FieldPoint at{random.real(-side_m / 2, side_m / 2), random.real(-side_m / 2, side_m / 2)};
      if (patches_near(at, static_cast<ColorId>(color), list) < 2)
        list.add(at, static_cast<ColorId>(color), parameters.teams[0].layout.patches[0],
                 parameters.teams[0].layout.height_m, 0.02f);
    }
    const Sightings& seen = list.match();
    ASSERT_FALSE(seen.cut_short);
    for (const Team team : {Team::kOwn, Team::kOpponent}) {
      const TeamMarking& marking = parameters.teams[static_cast<std::size_t>(team)];
      if (marking.team_color == kBackground) continue;
      std::vector<literal::Region> regions;
      for (const Region& region : list.regions()) {
        regions.push_back({region.color, list.camera().to_field(region.centroid, marking.layout.height_m),
                           static_cast<float>(region.area_px)});
      }
      std::vector<ColorId> colors;
      for (const RobotMarking& robot : marking.robots) colors.push_back(robot.colors[0]);
      const literal::Table table = literal::make_table(regions, marking.team_color, colors);
      const literal::Solution rules = literal::solve(table);
      std::size_t entries = 0;
      for (const auto& row : table.entry) entries += static_cast<std::size_t>(std::count(row.begin(), row.end(), true));
      tally.contested += entries > colors.size() ? 1 : 0;
      tally.robots += 5;
      for (const RobotSighting& robot : seen.robots) {
        if (robot.team != team || robot.id == kUnknownId) continue;
        ++tally.sure;
        const auto row = static_cast<std::size_t>(robot.id);
        const auto pair =
            std::find_if(rules.pairs.begin(), rules.pairs.end(), [row](const Pair& p) { return p.row == row; });
        if (!rules.unambiguous) continue;
        ASSERT_NE(pair, rules.pairs.end());
        const Pose expected = literal::pose(literal::refined(regions, table.columns[pair->column]),
                                            literal::refined(regions, table.rows[row]));
        EXPECT_LT(distance_m(robot.pose.position, expected.position), 1e-4f) << "arrangement " << n << " id " << row;
        EXPECT_LT(std::abs(wrap_angle(robot.pose.theta_rad - expected.theta_rad)), 0.005f)
            << "arrangement " << n << " id " << row;
      }
      tally.unambiguous += rules.unambiguous ? 5 : 0;
    }
    const Comparison result = compare(placed, seen, parameters);
    EXPECT_EQ(result.wrong + result.ghosts + result.missed, 0u) << "arrangement " << n;
  }
}

// The comparison excludes cases that the text does not decide: tables in which the left-over rule has a choice, and
// arrangements with a missing patch (a column without its row takes a neighbor's patch by the column rule). A robot
// without an id from the matcher counts as no answer; their maximum number is asserted.
TEST(PaperRules, AgreeWithTheMatcherOnAWideField) {
  Tally tally;
  compare_with_matcher(paper_teams(), 1.7f, 0.001f, 1, 2000, tally);
  EXPECT_GT(tally.unambiguous, tally.robots * 99 / 100);
  EXPECT_GT(tally.sure, tally.robots * 999 / 1000);
}

// Ten robots within half a meter.
TEST(PaperRules, AgreeWithTheMatcherInACrowd) {
  Tally tally;
  compare_with_matcher(paper_teams(), 0.5f, 0.001f, 2, 3000, tally);
  EXPECT_GT(tally.contested, 1000);
  EXPECT_GT(tally.unambiguous, tally.robots * 95 / 100);
  EXPECT_GT(tally.sure, tally.robots * 99 / 100);
}

// A whole team in a cluster, as after a collision: most tables have conflicts. The errors of the patch centers are
// those of dull colors.
TEST(PaperRules, AgreeWithTheMatcherInACluster) {
  MarkerParameters parameters = paper_teams();
  parameters.teams[1] = {};
  Tally tally;
  compare_with_matcher(parameters, 0.23f, 0.003f, 3, 4000, tally);
  EXPECT_GT(tally.contested, 2000);
  EXPECT_GT(tally.unambiguous, tally.robots * 95 / 100);
  EXPECT_GT(tally.sure, tally.robots * 99 / 100);
}

}  // namespace
}  // namespace touchline::testing
