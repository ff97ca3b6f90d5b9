#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "core/region/region_scanner.h"
#include "tests/region/patterns.h"
#include "tests/region/region_comparison.h"
#include "tests/region/tile_recipe.h"

// Pictures with more runs or regions than the capacity or the time limit allows, and realistic pictures, of which
// nothing may be dropped.
namespace touchline::testing {
namespace {

constexpr ColorId kPatchColor = 2, kClutterColor = 4;

struct Square {
  int left, top, side;
};
void draw(ColorGrid& grid, const Square& square, ColorId color) {
  for (int v = square.top; v < square.top + square.side; ++v) {
    std::fill_n(&grid.at(square.left, v), square.side, color);
  }
}

class OverloadTest : public ::testing::Test {
 protected:
  Status scan(const ColorGrid& grid, std::uint32_t min_area_px, std::uint32_t min_height_px = 1) {
    const OwnedPicture picture = paint(grid, PixelFormat::kNv12, 0, random_);
    ScanParameters parameters = parameters_for(picture.frame());
    parameters.min_area_px = min_area_px;
    parameters.min_height_px = min_height_px;
    if (Status s = scanner_->configure(parameters); !s.ok()) return s;
    return scanner_->scan(picture.frame(), *runs_, *regions_);
  }

  // 22 robots with six patches each, in a line or all over the picture. The patches have ragged edges: every other row
  // of a patch has two runs. On a field of 480 rows, patches are 12 pixels wide.
  ColorGrid crowded_field(int width, int height, bool in_line, int specks, int specks_on_top = 0) {
    ColorGrid grid = make_grid(width, height);
    draw_specks(grid, specks);
    const int side = height / 40, pitch = side + 2, columns = in_line ? 22 : 6;
    for (int robot = 0; robot < 22; ++robot) {
      const int u0 = robot % columns * (width / columns), v0 = robot / columns * (height / 5);
      for (int patch = 0; patch < 6; ++patch) {
        const Square square = {u0 + patch % 2 * pitch, v0 + patch / 2 * pitch, side};
        draw(grid, square, static_cast<ColorId>(1 + patch % kPaletteColors));
        for (int v = square.top; v < square.top + side; v += 2) grid.at(square.left + side - 2, v) = kBackground;
      }
    }
    draw_specks(grid, specks_on_top);
    return grid;
  }

  void draw_specks(ColorGrid& grid, int count) {
    for (int i = 0; i < count; ++i) {
      grid.at(pick(random_, 0, grid.width - 1), pick(random_, 0, grid.height - 1)) =
          static_cast<ColorId>(pick(random_, 1, kPaletteColors));
    }
  }

  std::unique_ptr<RegionScanner> scanner_ = std::make_unique<RegionScanner>();
  std::unique_ptr<Runs> runs_ = std::make_unique<Runs>();
  std::unique_ptr<Regions> regions_ = std::make_unique<Regions>();
  std::mt19937 random_{5};
};

TEST_F(OverloadTest, ARealisticFieldLosesNoRuns) {
  for (const auto& [width, height] : {std::pair(640, 480), std::pair(1920, 1080)}) {
    for (const bool in_line : {false, true}) {
      const ColorGrid grid = crowded_field(width, height, in_line, 6000);
      EXPECT_TRUE(scan(grid, 2).ok()) << width << " x " << height << ", " << count_runs(grid) << " runs";
      EXPECT_EQ(difference(expected_regions(grid, 2), *runs_, *regions_), "") << width << " x " << height;
      EXPECT_GE(std::count_if(regions_->begin(), regions_->end(), [](const Region& r) { return r.area_px > 100; }),
                132);
    }
  }
}

TEST_F(OverloadTest, ARealisticFieldWithSpecksOnItsPatchesLosesNoRuns) {
  const ColorGrid grid = crowded_field(640, 480, true, 0, 3000);
  EXPECT_TRUE(scan(grid, 2).ok());
  EXPECT_EQ(difference(expected_regions(grid, 2), *runs_, *regions_), "");
}

TEST_F(OverloadTest, SpecksUseRunsOnlyIfTheyCountAsRegions) {
  const ColorGrid grid = crowded_field(640, 480, true, 9000);
  EXPECT_EQ(scan(grid, 1).code(), ErrorCode::kFull);
  EXPECT_EQ(difference_from_limited(grid, 1, *runs_, *regions_), "");
  EXPECT_TRUE(scan(grid, 2).ok());
  EXPECT_EQ(difference(expected_regions(grid, 2), *runs_, *regions_), "");
}

TEST_F(OverloadTest, EveryPatternGivesTheRegionsOfItsKeptRuns) {
  std::size_t cut = 0;
  for (const Pattern pattern : kAllPatterns) {
    for (const std::uint32_t min_height : {1u, 2u}) {
      for (const std::uint32_t min_area : {1u, 2u, 12u}) {
        const ColorGrid grid = make_pattern(pattern, pick(random_, 300, 350), 200, random_);
        const Status status = scan(grid, min_area, min_height);
        ASSERT_EQ(difference_from_limited(grid, min_area, *runs_, *regions_, min_height), "")
            << name_of(pattern) << ", " << min_area << ", " << min_height;
        EXPECT_EQ(status.ok(), runs_->overflow() + regions_->overflow() == 0) << name_of(pattern) << ", " << min_area;
        cut += runs_->overflow() > 0 ? 1u : 0u;
      }
    }
  }
  EXPECT_GE(cut, 24u);
}

// Of every region that is reported, whether a pixel of its color that was dropped touches it.
TEST_F(OverloadTest, OnlyRegionsThatLostRunsAreCut) {
  std::size_t cut = 0, whole = 0;
  for (const Pattern pattern : kAllPatterns) {
    for (const std::uint32_t min_height : {1u, 2u}) {
      ColorGrid grid = crowded_field(640, 240, false, 500);
      const ColorGrid clutter = make_pattern(pattern, 640, 100, random_);
      std::copy(clutter.color.begin(), clutter.color.end(), &grid.at(0, 100));
      static_cast<void>(scan(grid, 2, min_height));
      const LimitedPicture kept = without_dropped_runs(grid, 2, min_height);
      const auto is_lost = [&](int u, int v, ColorId color) {
        return u >= 0 && v >= 0 && u < grid.width && v < grid.height && grid.at(u, v) == color &&
               kept.grid.at(u, v) != color;
      };
      for (const Region& region : *regions_) {
        bool is_cut = false;
        for (std::uint32_t i = region.first_run; i != kNoRun; i = (*runs_)[i].next) {
          const touchline::Run& run = (*runs_)[i];
          for (int u = run.begin; u < run.end; ++u) {
            is_cut = is_cut || is_lost(u, run.row - 1, region.color) || is_lost(u, run.row + 1, region.color);
          }
        }
        ASSERT_EQ(region.is_cut, is_cut) << name_of(pattern) << " " << region.box.left << ", " << region.box.top;
        ++(is_cut ? cut : whole);
      }
    }
  }
  EXPECT_GE(cut, 500u);
  EXPECT_GE(whole, 2000u);
}

TEST_F(OverloadTest, RowsThatAreNotReadUseNoRuns) {
  ColorGrid grid = make_grid(640, 100);
  for (int v = 1; v < 99; v += 2) {
    for (int u = 0; u + 1 < 640; u += 4) grid.at(u, v) = grid.at(u + 1, v) = 3;
  }
  EXPECT_EQ(scan(grid, 1).code(), ErrorCode::kFull);
  EXPECT_TRUE(scan(grid, 1, 2).ok());
  EXPECT_TRUE(runs_->empty());
  // One column has a color: the 64 columns around it are read, which end with background.
  for (int v = 0; v < 100; v += 2) grid.at(200, v) = 3;
  EXPECT_EQ(scan(grid, 1, 2).code(), ErrorCode::kFull);
  EXPECT_EQ(difference_from_limited(grid, 1, *runs_, *regions_, 2), "");
  EXPECT_LT(runs_->overflow(), 49u * 17u) << "only the runs of these columns were counted";
}

TEST_F(OverloadTest, TheLimitHoldsForTheWidestRunsAndPictures) {
  // Stripes of many widths. With some of them every row has too many runs of the greatest length.
  for (const auto& [width, height, stripe] :
       {std::tuple(640, 480, 7), std::tuple(640, 480, 8), std::tuple(640, 480, 19), std::tuple(2592, 700, 63),
        std::tuple(2592, 700, 70)}) {
    ColorGrid grid = make_grid(width, height);
    for (int v = 0; v < height; ++v) {
      for (int u = 0; u < width; ++u) grid.at(u, v) = static_cast<ColorId>(1 + (u + v / 3) / stripe % kPaletteColors);
    }
    EXPECT_EQ(scan(grid, 1).code(), ErrorCode::kFull) << stripe;
    EXPECT_EQ(difference_from_limited(grid, 1, *runs_, *regions_), "") << stripe;
    EXPECT_LE(runs_->size(),
              RunLimiter::reserve(static_cast<std::size_t>(height)) + kRunsPerRow * static_cast<std::size_t>(height));
  }
}

TEST_F(OverloadTest, RegionsOutsideABandOfClutterAreExact) {
  for (const Pattern pattern : {Pattern::kSalt, Pattern::kVerticalStripes, Pattern::kPercolation, Pattern::kStairs}) {
    ColorGrid grid = crowded_field(640, 480, false, 500);
    const ColorGrid clutter = make_pattern(pattern, 640, 70, random_);
    std::copy(clutter.color.begin(), clutter.color.end(), &grid.at(0, 200));
    EXPECT_EQ(scan(grid, 2).code(), ErrorCode::kFull) << name_of(pattern);
    std::size_t outside = 0;
    for (const ExpectedRegion& region : expected_regions(grid, 2)) {
      if (region.bottom >= 199 && region.top <= 270) continue;
      ++outside;
      EXPECT_TRUE(std::any_of(regions_->begin(), regions_->end(),
                              [&](const Region& found) {
                                return found.color == region.color && found.area_px == region.pixels.size() &&
                                       found.box.left == region.left && found.box.top == region.top &&
                                       found.centroid.u_px == static_cast<float>(region.centroid_u);
                              }))
          << name_of(pattern) << ": " << region.left << ", " << region.top;
    }
    EXPECT_GE(outside, 90u);
  }
}

// Clutter that has no more runs per row than a realistic row.
TEST_F(OverloadTest, ABandOfModerateClutterLeavesTenRobotsComplete) {
  for (const auto& [runs, rows] : {std::pair(30, 80), std::pair(40, 80), std::pair(60, 60), std::pair(100, 30),
                                   std::pair(100, 120), std::pair(128, 100), std::pair(140, 60)}) {
    ColorGrid grid = make_grid(640, 480);
    for (int v = 0; v < rows; ++v) {
      for (int i = 0; i < runs; ++i) std::fill_n(&grid.at(i * (638 / runs) + v % 2, v), 3, kClutterColor);
    }
    std::vector<Square> patches;
    for (int robot = 0; robot < 10; ++robot) {
      for (int patch = 0; patch < 6; ++patch) {
        patches.push_back({40 + robot % 5 * 120 + patch % 2 * 14, 150 + robot / 5 * 150 + patch / 2 * 14, 12});
        draw(grid, patches.back(), static_cast<ColorId>(1 + patch % 3));
      }
    }
    static_cast<void>(scan(grid, 2));
    EXPECT_EQ(difference_from_limited(grid, 2, *runs_, *regions_), "") << runs << " runs, " << rows << " rows";
    EXPECT_EQ(std::count_if(regions_->begin(), regions_->end(), [](const Region& r) { return r.area_px == 144; }), 60)
        << runs << " runs, " << rows << " rows";
  }
}

TEST_F(OverloadTest, PatchesInsideFineClutterAreMostlyKept) {
  ColorGrid grid = make_grid(640, 480);
  for (int v = 0; v < 480; ++v) {
    for (int u = 0; u < 640; ++u) grid.at(u, v) = pick(random_, 0, 2) == 0 ? kClutterColor : kBackground;
  }
  std::vector<Square> patches;
  for (int i = 0; i < 20; ++i) patches.push_back({20 + 31 * i, 30 + 97 * i % 400, 12});
  for (const Square& patch : patches) draw(grid, patch, kPatchColor);
  EXPECT_EQ(scan(grid, 2).code(), ErrorCode::kFull);
  for (const Square& patch : patches) {
    EXPECT_TRUE(std::any_of(regions_->begin(), regions_->end(),
                            [&](const Region& found) {
                              return found.color == kPatchColor && found.area_px == 144 &&
                                     found.box.left == patch.left && found.box.top == patch.top;
                            }))
        << patch.left << ", " << patch.top;
  }
}

TEST_F(OverloadTest, TheLargestRegionsAreKeptAndTheOthersCounted) {
  // 4,320 regions in a picture that is high enough for their runs.
  ColorGrid grid = make_grid(640, 960);
  for (int v = 0; v < 480; v += 2) {
    for (int u = 0; u < 18; ++u) grid.at(35 * u + v % 7, v) = grid.at(35 * u + v % 7 + pick(random_, 0, 1), v) = 3;
  }
  EXPECT_EQ(scan(grid, 1).code(), ErrorCode::kFull);
  EXPECT_EQ(difference_from_limited(grid, 1, *runs_, *regions_), "");
  EXPECT_EQ(regions_->size(), kMaxRegions);
  EXPECT_EQ(regions_->overflow(), 240u * 18u - kMaxRegions);
  EXPECT_EQ(runs_->overflow(), 0u);
}

TEST_F(OverloadTest, AFullListOfRegionsIsNoOverload) {
  // 240 rows of 17 single pixels, one of 16, and then one region more.
  static_assert(240 * 17 + 16 == kMaxRegions);
  ColorGrid grid = make_grid(640, 960);
  for (int v = 0; v <= 480; v += 2) {
    for (int i = 0; i < (v < 480 ? 17 : 16); ++i) grid.at(36 * i, v) = 3;
  }
  EXPECT_TRUE(scan(grid, 1).ok());
  EXPECT_EQ(regions_->size(), kMaxRegions);
  grid.at(630, 481) = grid.at(631, 481) = 2;
  EXPECT_EQ(scan(grid, 1).code(), ErrorCode::kFull);
  EXPECT_EQ(regions_->size(), kMaxRegions);
  EXPECT_EQ(regions_->overflow(), 1u);
  EXPECT_EQ(regions_->back().area_px, 2u) << "the larger one is kept although it comes last";
  EXPECT_EQ((*regions_)[kMaxRegions - 2].centroid.u_px, 504.0f) << "the last of the small ones is dropped";
}

TEST_F(OverloadTest, CountsOnlyRunsInTheRegionOfInterest) {
  // The region of interest has two strips of a striped picture. Runs outside are neither kept nor counted.
  const ColorGrid grid = make_pattern(Pattern::kVerticalStripes, 640, 480, random_);
  const OwnedPicture picture = paint(grid, PixelFormat::kYuyv, 6, random_);
  ScanParameters parameters = parameters_for(picture.frame());
  for (const PixelPoint& point :
       {PixelPoint{10, 30}, PixelPoint{630, 30}, PixelPoint{630, 470}, PixelPoint{400, 470}, PixelPoint{400, 31},
        PixelPoint{301, 31}, PixelPoint{301, 470}, PixelPoint{10, 470}}) {
    parameters.region_of_interest.push_back(point);
  }
  ASSERT_TRUE(scanner_->configure(parameters).ok());
  EXPECT_EQ(scanner_->scan(picture.frame(), *runs_, *regions_).code(), ErrorCode::kFull);
  const ColorGrid seen = defined_colors(picture.frame(), parameters);
  EXPECT_GT(runs_->overflow(), 200000u);
  EXPECT_EQ(difference_from_limited(seen, 1, *runs_, *regions_), "");
}

TEST_F(OverloadTest, DoesNotAffectTheNextFrame) {
  const ColorGrid calm = make_pattern(Pattern::kBlobs, 640, 480, random_);
  const std::vector<ExpectedRegion> expected = expected_regions(calm);
  for (const Pattern pattern : {Pattern::kVerticalStripes, Pattern::kSalt, Pattern::kCombUp}) {
    EXPECT_EQ(scan(make_pattern(pattern, 640, 480, random_), 1).code(), ErrorCode::kFull) << name_of(pattern);
    EXPECT_TRUE(scan(calm, 1).ok());
    EXPECT_EQ(difference(expected, *runs_, *regions_), "") << "after " << name_of(pattern);
    EXPECT_EQ(runs_->overflow() + regions_->overflow(), 0u);
  }
}

TEST(TileRecipeTest, ReadsBackItsText) {
  TileRecipe recipe;
  recipe.width = recipe.height = 24;
  recipe.scale_u = 16, recipe.scale_v = 64;
  recipe.shift = 24, recipe.noise_per_mille = 1000, recipe.runs = 40, recipe.seed = 4294967295u;
  for (int i = 0; i < 24 * 24; ++i) recipe.cells += static_cast<char>('0' + i % (kPaletteColors + 1));
  EXPECT_FALSE(recipe_of(text_of(recipe))) << "one cell too many";
  recipe.cells.erase(0, 1);
  ASSERT_TRUE(recipe_of(text_of(recipe)));
  EXPECT_EQ(text_of(*recipe_of(text_of(recipe))), text_of(recipe));
  recipe.cells.back() = '6';
  EXPECT_FALSE(recipe_of(text_of(recipe))) << "there is no color 6";
}

}  // namespace
}  // namespace touchline::testing
