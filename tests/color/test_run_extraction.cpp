#include <gtest/gtest.h>

#include <vector>

#include "core/color/run_extraction.h"
#include "tests/color/owned_picture.h"

namespace touchline::testing {
namespace {

struct Found {
  int begin, end, color;
  friend bool operator==(const Found&, const Found&) = default;
};
void PrintTo(const Found& run, std::ostream* out) { *out << "[" << run.begin << ", " << run.end << ") " << run.color; }

std::vector<Found> extract(std::vector<ColorId> colors, std::uint16_t begin, std::uint16_t end) {
  colors.resize(end);
  colors.resize(end + kColorRowPadding, kBackground);
  std::vector<Run> runs(end - begin + 1u);
  const std::size_t count = extract_runs(colors.data(), begin, end, 5, runs.data());
  EXPECT_EQ(count, count_runs(colors.data(), begin, end));
  std::vector<Found> found;
  for (std::size_t i = 0; i < count; ++i) {
    EXPECT_EQ(runs[i].row, 5);
    found.push_back({runs[i].begin, runs[i].end, runs[i].color});
  }
  return found;
}

TEST(ExtractRuns, KeepsTheFirstPixelOfEveryRun) {
  // A run that follows another without a gap, after one pixel of gap, and at both ends.
  EXPECT_EQ(extract({1, 1, 2, 2, 2, 0, 2, 0, 0, 3}, 0, 10),
            (std::vector<Found>{{0, 2, 1}, {2, 5, 2}, {6, 7, 2}, {9, 10, 3}}));
  EXPECT_EQ(extract({1, 1, 1, 1}, 1, 3), (std::vector<Found>{{1, 3, 1}})) << "the span cuts";
  EXPECT_EQ(extract({0, 0, 0}, 0, 3), (std::vector<Found>{}));
  EXPECT_EQ(extract({4}, 0, 1), (std::vector<Found>{{0, 1, 4}}));
  EXPECT_EQ(extract({4}, 1, 1), (std::vector<Found>{})) << "an empty span";
}

TEST(ExtractRuns, AgreesWithLookingAtEachPixel) {
  std::mt19937 random(11);
  for (int round = 0; round < 3000; ++round) {
    std::vector<ColorId> colors(static_cast<std::size_t>(pick(random, 1, 70)));
    const int density = pick(random, 0, 3);  // from mostly background to none
    for (ColorId& color : colors) {
      color = pick(random, 0, 9) < 3 * density + 1 ? static_cast<ColorId>(pick(random, 1, 1 + density)) : kBackground;
    }
    const int last = static_cast<int>(colors.size());
    const int begin = pick(random, 0, last), end = pick(random, begin, last);
    std::vector<Found> expected;
    for (int u = begin; u < end; ++u) {
      const ColorId color = colors[static_cast<std::size_t>(u)];
      if (color == kBackground) continue;
      if (!expected.empty() && expected.back().end == u && expected.back().color == color) {
        ++expected.back().end;
      } else {
        expected.push_back({u, u + 1, color});
      }
    }
    ASSERT_EQ(extract(colors, static_cast<std::uint16_t>(begin), static_cast<std::uint16_t>(end)), expected);
  }
}

}  // namespace
}  // namespace touchline::testing
