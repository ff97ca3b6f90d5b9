#include <gtest/gtest.h>

#include <array>
#include <memory>

#include "tests/marker/real_layouts.h"
#include "tests/marker/region_list.h"

// The matcher's bounds of work. Frames of the largest teams never reach them.
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

TEST(WorkBound, WorkThatIsNotNeededIsLeftToOthers) {
  const MarkerParameters parameters = paper_teams();
  std::array<TeamPatch, 4> patches{};
  const PatchLists lists{patches, {}};
  int work = 100;
  const auto hypotheses = std::make_unique<Hypotheses>();
  for (std::size_t i = 0; i < patches.size(); ++i) {
    EXPECT_TRUE(add_hypotheses(parameters.teams, lists, i, work, *hypotheses));
  }
  EXPECT_EQ(work, 100);
}

}  // namespace
}  // namespace touchline::testing
