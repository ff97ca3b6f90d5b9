#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <numeric>
#include <ostream>

#include "tests/region/patterns.h"
#include "tests/region/region_comparison.h"

// Tests the comparison with the literal algorithm: it must detect every typical mistake of run-based labeling. Each one
// is planted in turn into a labeling that is correct without it.
namespace touchline::testing {
namespace {

enum class Fault {
  kNone,
  kLosesFirstPixelOfLaterRuns,  // if a run ends where the next run begins, it takes the first pixel of the next run
  kLinksOnlyTheFirstAbove,      // a run that touches several runs above joins only one of them
  kLinksOnlyTheFirstBelow,      // a run that touches several runs below is joined to only one of them
  kTakesDiagonals,              // 8-neighborhood
  kJoinsTouchingColors,
  kSumsInFloat,
  kStopsSilently,  // after 2,000 runs
};

void find_runs(const ColorGrid& grid, Fault fault, Runs& runs) {
  for (int v = 0; v < grid.height; ++v) {
    for (int u = 0; u < grid.width;) {
      int begin = u++;
      while (u < grid.width && grid.at(u, v) == grid.at(begin, v)) ++u;
      const int end = u;
      if (grid.at(begin, v) == kBackground) continue;
      if (fault == Fault::kLosesFirstPixelOfLaterRuns && begin > 0 && grid.at(begin - 1, v) != kBackground) ++begin;
      if (fault == Fault::kStopsSilently && runs.size() == 2000) return;
      if (begin == end) continue;
      runs.push_back({static_cast<std::uint16_t>(v), static_cast<std::uint16_t>(begin), static_cast<std::uint16_t>(end),
                      grid.at(begin, v), kNoRun});
    }
  }
}

std::size_t root(const std::vector<std::size_t>& parent, std::size_t i) {
  while (parent[i] != i) i = parent[i];
  return i;
}

std::vector<std::size_t> link_runs(const Runs& runs, Fault fault) {
  std::vector<std::size_t> parent(runs.size());
  std::iota(parent.begin(), parent.end(), 0u);
  std::vector<bool> linked_below(runs.size());
  std::size_t above_from = 0;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    while (runs[above_from].row + 1 < runs[i].row) ++above_from;
    const int extent = fault == Fault::kTakesDiagonals ? 1 : 0;
    for (std::size_t j = above_from; j < i && runs[j].row < runs[i].row; ++j) {
      if (runs[j].end + extent <= runs[i].begin || runs[j].begin >= runs[i].end + extent) continue;
      if (runs[j].color != runs[i].color && fault != Fault::kJoinsTouchingColors) continue;
      if (fault == Fault::kLinksOnlyTheFirstBelow && linked_below[j]) continue;
      const auto [low, high] = std::minmax({root(parent, i), root(parent, j)});
      parent[high] = low;
      linked_below[j] = true;
      if (fault == Fault::kLinksOnlyTheFirstAbove) break;
    }
  }
  return parent;
}

template <class Sum>
void sum_regions(Runs& runs, const std::vector<std::size_t>& parent, Regions& regions) {
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (root(parent, i) != i) continue;
    Region region;
    region.color = runs[i].color;
    region.first_run = static_cast<std::uint32_t>(i);
    region.box = {runs[i].begin, runs[i].row, runs[i].begin, runs[i].row};
    Sum sum_u = 0, sum_v = 0;
    std::size_t last = i;
    for (std::size_t j = i; j < runs.size(); ++j) {
      if (root(parent, j) != i) continue;
      if (j != i) runs[last].next = static_cast<std::uint32_t>(j);
      last = j;
      for (std::uint16_t u = runs[j].begin; u < runs[j].end; ++u) {
        sum_u += static_cast<Sum>(u);
        sum_v += static_cast<Sum>(runs[j].row);
        ++region.area_px;
      }
      region.box.left = std::min(region.box.left, runs[j].begin);
      region.box.right = std::max(region.box.right, static_cast<std::uint16_t>(runs[j].end - 1));
      region.box.bottom = runs[j].row;
    }
    region.centroid = {static_cast<float>(static_cast<double>(sum_u) / region.area_px),
                       static_cast<float>(static_cast<double>(sum_v) / region.area_px)};
    regions.push_back(region);
  }
}

struct PlantedFault {
  Fault fault;
  const char* name;
};
void PrintTo(const PlantedFault& planted, std::ostream* out) { *out << planted.name; }

class PlantedFaultTest : public ::testing::TestWithParam<PlantedFault> {};

TEST_P(PlantedFaultTest, IsDetectedByTheComparison) {
  const Fault fault = GetParam().fault;
  std::mt19937 random(1);
  const auto runs = std::make_unique<Runs>();
  const auto regions = std::make_unique<Regions>();
  std::size_t caught = 0;
  for (const Pattern pattern : kAllPatterns) {
    // A full picture is so large that sums of floats are inexact.
    const bool large = pattern == Pattern::kFull || pattern == Pattern::kHorizontalStripes;
    const ColorGrid grid = make_pattern(pattern, large ? 640 : 96, large ? 480 : 64, random);
    runs->clear();
    regions->clear();
    find_runs(grid, fault, *runs);
    const std::vector<std::size_t> parent = link_runs(*runs, fault);
    if (fault == Fault::kSumsInFloat) {
      sum_regions<float>(*runs, parent, *regions);
    } else {
      sum_regions<std::uint64_t>(*runs, parent, *regions);
    }
    caught += difference(expected_regions(grid), *runs, *regions).empty() ? 0u : 1u;
  }
  if (fault == Fault::kNone) {
    EXPECT_EQ(caught, 0u) << "without a planted fault the labeling must be correct";
  } else {
    EXPECT_GT(caught, 0u);
  }
}

INSTANTIATE_TEST_SUITE_P(Planted, PlantedFaultTest,
                         ::testing::Values(PlantedFault{Fault::kNone, "none"},
                                           PlantedFault{Fault::kLosesFirstPixelOfLaterRuns, "loses_first_pixel"},
                                           PlantedFault{Fault::kLinksOnlyTheFirstAbove, "links_first_above"},
                                           PlantedFault{Fault::kLinksOnlyTheFirstBelow, "links_first_below"},
                                           PlantedFault{Fault::kTakesDiagonals, "takes_diagonals"},
                                           PlantedFault{Fault::kJoinsTouchingColors, "joins_touching_colors"},
                                           PlantedFault{Fault::kSumsInFloat, "sums_in_float"},
                                           PlantedFault{Fault::kStopsSilently, "stops_silently"}),
                         [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace touchline::testing
