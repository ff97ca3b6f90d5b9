#include <gtest/gtest.h>

#include <memory>

#include "core/region/region_scanner.h"
#include "tests/region/patterns.h"
#include "tests/region/region_comparison.h"

// Pictures with more runs or regions than there is room for.
namespace touchline::testing {
namespace {

class OverloadTest : public ::testing::Test {
 protected:
  Status scan(const ColorGrid& grid, std::uint32_t min_area_px) {
    const OwnedPicture picture = paint(grid, PixelFormat::kNv12, 0, random_);
    ScanParameters parameters = parameters_for(picture.frame());
    parameters.min_area_px = min_area_px;
    if (Status s = scanner_->configure(parameters); !s.ok()) return s;
    return scanner_->scan(picture.frame(), *runs_, *regions_);
  }

  std::unique_ptr<RegionScanner> scanner_ = std::make_unique<RegionScanner>();
  std::unique_ptr<Runs> runs_ = std::make_unique<Runs>();
  std::unique_ptr<Regions> regions_ = std::make_unique<Regions>();
  std::mt19937 random_{5};
};

TEST_F(OverloadTest, RunsOfDroppedSpecksMakeRoom) {
  // Robots' patches must not get lost because of noise above them in the picture.
  const ColorGrid grid = make_pattern(Pattern::kSalt, 640, 480, random_);
  ASSERT_GT(runs_from_row(grid, 0), 6 * kMaxRuns);
  const std::vector<ExpectedRegion> expected = expected_regions(grid, 8);
  ASSERT_GT(expected.size(), 100u);
  EXPECT_TRUE(scan(grid, 8).ok());
  EXPECT_EQ(difference(expected, *runs_, *regions_), "");
  EXPECT_EQ(runs_->overflow() + regions_->overflow(), 0u);
}

TEST_F(OverloadTest, TheLargestRegionsStayAndTheOthersAreCounted) {
  for (const Pattern pattern : {Pattern::kSalt, Pattern::kWideCheckerboard}) {
    const ColorGrid grid = make_pattern(pattern, 640, 480, random_);
    EXPECT_EQ(scan(grid, 1).code(), ErrorCode::kFull) << name_of(pattern);
    EXPECT_EQ(difference_when_full(grid, 1, *runs_, *regions_), "") << name_of(pattern);
    EXPECT_EQ(regions_->size(), kMaxRegions) << name_of(pattern);
    EXPECT_GT(regions_->overflow(), 0u) << name_of(pattern);
    EXPECT_EQ(runs_->overflow(), 0u) << name_of(pattern);
  }
}

TEST_F(OverloadTest, ExactlyAsManyRegionsAsFitAreNoOverload) {
  // 64 x 64 single pixels, and then one more.
  ColorGrid grid = make_grid(160, 130);
  for (int v = 0; v < 128; v += 2) {
    for (int u = 0; u < 128; u += 2) grid.at(u, v) = 3;
  }
  EXPECT_TRUE(scan(grid, 1).ok());
  EXPECT_EQ(regions_->size(), kMaxRegions);
  grid.at(150, 129) = grid.at(151, 129) = 2;
  EXPECT_EQ(scan(grid, 1).code(), ErrorCode::kFull);
  EXPECT_EQ(regions_->size(), kMaxRegions);
  EXPECT_EQ(regions_->overflow(), 1u);
  EXPECT_EQ(regions_->back().area_px, 2u) << "the larger one stays although it comes last";
  EXPECT_EQ((*regions_)[kMaxRegions - 2].centroid.u_px, 124.0f) << "the last of the small ones makes room";
}

TEST_F(OverloadTest, StripesEndTheScanAtARowAndAreCounted) {
  const ColorGrid grid = make_pattern(Pattern::kVerticalStripes, 640, 480, random_);
  EXPECT_EQ(scan(grid, 1).code(), ErrorCode::kFull);
  const int row = row_of_end(grid, *runs_);
  EXPECT_GE(row, static_cast<int>(kMaxRuns / 640) - 1);
  EXPECT_LT(row, 480);
  EXPECT_TRUE(runs_->empty());
  EXPECT_TRUE(regions_->empty()) << "none of them was seen to its end";
  EXPECT_EQ(regions_->overflow(), 640u);
}

TEST_F(OverloadTest, WhatEndedBeforeTheStripesIsWhole) {
  for (const Pattern pattern : {Pattern::kBlobs, Pattern::kSalt, Pattern::kPercolation}) {
    ColorGrid grid = make_pattern(pattern, 640, 480, random_);
    const int stripes_from = 100;
    for (int v = stripes_from; v < 480; ++v) {
      for (int u = 0; u < 640; ++u) grid.at(u, v) = static_cast<ColorId>(1 + u % 2);
    }
    EXPECT_EQ(scan(grid, 12).code(), ErrorCode::kFull) << name_of(pattern);
    const int row = row_of_end(grid, *runs_);
    ASSERT_GT(row, stripes_from) << name_of(pattern);
    ASSERT_LT(row, 480) << name_of(pattern);
    EXPECT_FALSE(regions_->empty()) << name_of(pattern);
    EXPECT_EQ(difference_when_full(grid, 12, *runs_, *regions_), "") << name_of(pattern);
  }
}

TEST_F(OverloadTest, TheWidestPicturesAreBoundedToo) {
  for (const Pattern pattern :
       {Pattern::kVerticalStripes, Pattern::kCombDown, Pattern::kPercolation, Pattern::kTwoColors}) {
    const ColorGrid grid = make_pattern(pattern, static_cast<int>(kMaxFrameWidth), 300, random_);
    EXPECT_EQ(scan(grid, 3).code(), ErrorCode::kFull) << name_of(pattern);
    ASSERT_GT(runs_->overflow(), 0u) << name_of(pattern);
    EXPECT_EQ(difference_when_full(grid, 3, *runs_, *regions_), "") << name_of(pattern);
  }
}

TEST_F(OverloadTest, CountsOnlyTheRegionOfInterest) {
  // Two strips of a picture of stripes: what lies between them, and beside them, is neither kept nor counted.
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
  const int row = row_of_end(seen, *runs_);
  ASSERT_GT(row, 31);
  ASSERT_LT(row, 470);
  EXPECT_EQ(runs_from_row(seen, row), static_cast<std::size_t>(470 - row) * (291 + 230));
  EXPECT_EQ(difference_when_full(seen, 1, *runs_, *regions_), "");
}

TEST_F(OverloadTest, LeavesNothingBehindForTheNextFrame) {
  const ColorGrid calm = make_pattern(Pattern::kBlobs, 640, 480, random_);
  const std::vector<ExpectedRegion> expected = expected_regions(calm);
  for (const Pattern pattern : {Pattern::kVerticalStripes, Pattern::kSalt, Pattern::kCombUp}) {
    EXPECT_EQ(scan(make_pattern(pattern, 640, 480, random_), 1).code(), ErrorCode::kFull) << name_of(pattern);
    EXPECT_TRUE(scan(calm, 1).ok());
    EXPECT_EQ(difference(expected, *runs_, *regions_), "") << "after " << name_of(pattern);
    EXPECT_EQ(runs_->overflow() + regions_->overflow(), 0u);
  }
}

}  // namespace
}  // namespace touchline::testing
