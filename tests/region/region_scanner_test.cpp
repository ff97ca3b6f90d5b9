#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <numeric>
#include <utility>

#include "core/region/region_scanner.h"
#include "tests/region/patterns.h"
#include "tests/region/region_comparison.h"

namespace touchline::testing {
namespace {

class RegionScannerTest : public ::testing::Test {
 protected:
  // Returns the first difference between the scan and the paper's algorithm on the colors by definition.
  std::string difference_on(const Frame& frame, const ScanParameters& parameters) {
    if (Status s = scanner_->configure(parameters); !s.ok()) return describe(s.code());
    if (Status s = scanner_->scan(frame, *runs_, *regions_); !s.ok()) return describe(s.code());
    return difference(
        expected_regions(defined_colors(frame, parameters), parameters.min_area_px, parameters.min_height_px), *runs_,
        *regions_);
  }

  std::unique_ptr<RegionScanner> scanner_ = std::make_unique<RegionScanner>();
  std::unique_ptr<Runs> runs_ = std::make_unique<Runs>();
  std::unique_ptr<Regions> regions_ = std::make_unique<Regions>();
  std::mt19937 random_{20260};
};

// Tall and flat pictures, single rows and columns, and sizes around those of blocks, tiles and words.
constexpr std::pair<int, int> kSizes[] = {{1, 1},   {1, 40},  {40, 1},  {2, 2},  {3, 5},   {7, 9},  {8, 8},   {15, 17},
                                          {16, 16}, {17, 15}, {33, 31}, {63, 9}, {64, 24}, {65, 9}, {95, 20}, {96, 5}};

TEST_F(RegionScannerTest, FindsTheRegionsOfThePaperInEveryPatternFormatAndSize) {
  std::size_t regions_seen = 0;
  for (const Pattern pattern : kAllPatterns) {
    for (const PixelFormat format : kAllFormats) {
      for (const auto& [width, height] : kSizes) {
        const OwnedPicture picture =
            paint(make_pattern(pattern, width, height, random_), format, pick(random_, 0, 9), random_);
        const Frame frame = picture.frame();
        ScanParameters parameters = parameters_for(frame);
        parameters.min_height_px = static_cast<std::uint32_t>(pick(random_, 1, 2));
        ASSERT_EQ(difference_on(frame, parameters), "") << name_of(pattern) << ", " << name_of(format) << ", " << width
                                                        << " x " << height << ", rows " << parameters.min_height_px;
        regions_seen += regions_->size();
      }
    }
  }
  EXPECT_GT(regions_seen, 20000u);
}

// All possible pictures up to a size, which covers every case of joining and merging.
TEST_F(RegionScannerTest, FindsTheRegionsOfThePaperInEverySmallPicture) {
  struct Family {
    int width, height, colors;
  };
  for (const Family& family : {Family{4, 4, 2}, Family{3, 3, 3}, Family{2, 3, 5}, Family{8, 2, 2}, Family{2, 8, 2}}) {
    OwnedPicture picture(PixelFormat::kRgb24, family.width, family.height, 1);
    ScanParameters parameters = parameters_for(picture.frame());
    ASSERT_TRUE(scanner_->configure(parameters).ok());
    const auto of_two_rows = std::make_unique<RegionScanner>();
    parameters.min_height_px = 2;
    ASSERT_TRUE(of_two_rows->configure(parameters).ok());
    ColorGrid grid = make_grid(family.width, family.height);
    bool more = true;
    while (more) {
      for (int v = 0; v < family.height; ++v) {
        for (int u = 0; u < family.width; ++u)
          picture.set(u, v, {static_cast<std::uint8_t>(40 * grid.at(u, v)), 0, 99});
      }
      ASSERT_TRUE(scanner_->scan(picture.frame(), *runs_, *regions_).ok());
      ASSERT_EQ(difference(expected_regions(grid), *runs_, *regions_), "")
          << family.width << " x " << family.height << ": "
          << ::testing::PrintToString(std::vector<int>(grid.color.begin(), grid.color.end()));
      ASSERT_TRUE(of_two_rows->scan(picture.frame(), *runs_, *regions_).ok());
      ASSERT_EQ(difference(expected_regions(grid, 1, 2), *runs_, *regions_), "")
          << ::testing::PrintToString(std::vector<int>(grid.color.begin(), grid.color.end()));
      // Counts to the next picture; the number of colors is the base.
      const auto nibble =
          std::find_if(grid.color.begin(), grid.color.end(), [&](ColorId color) { return color + 1 < family.colors; });
      more = nibble != grid.color.end();
      if (more) ++*nibble;
      std::fill(grid.color.begin(), nibble, kBackground);
    }
  }
}

TEST_F(RegionScannerTest, Distinguishes32Colors) {
  for (const PixelFormat format : kAllFormats) {
    OwnedPicture picture(format, 130, 66, 5);
    ScanParameters parameters = parameters_for(picture.frame());
    // Boxes that are adjacent in two channels, without gaps, in random order of colors.
    parameters.boxes.clear();
    for (int i = 0; i < static_cast<int>(kMaxColors); ++i) {
      const auto row = static_cast<std::uint8_t>(i / 8 * 40 + 80), column = static_cast<std::uint8_t>(i % 8 * 20 + 60);
      parameters.boxes.push_back({static_cast<ColorId>(1 + i * 5 % static_cast<int>(kMaxColors)),
                                  {0, row, column},
                                  {255, static_cast<std::uint8_t>(row + 39), static_cast<std::uint8_t>(column + 19)}});
    }
    std::size_t first = 0, second = 0;
    ASSERT_FALSE(overlapping_boxes(parameters.boxes, first, second));
    picture.fill([] { return std::uint8_t{0}; });
    // A picture of touching squares of 4 x 4 pixels with values at the bounds of their boxes.
    for (int v = 0; v < 64; ++v) {
      for (int u = 0; u < 128; ++u) {
        const ColorBox& box = parameters.boxes[static_cast<std::size_t>((u / 4 + v / 4 * 7) % 32)];
        picture.set(u, v, (u + v) / 8 % 2 == 0 ? box.low : box.high);
      }
    }
    ASSERT_EQ(difference_on(picture.frame(), parameters), "") << name_of(format);
    std::array<int, kMaxColors + 1> seen{};
    for (const Region& region : *regions_) ++seen[region.color];
    for (std::size_t color = 1; color <= kMaxColors; ++color)
      EXPECT_GT(seen[color], 0) << name_of(format) << " " << color;
    EXPECT_EQ(seen[kBackground], 0);
  }
}

LightMap random_light(std::mt19937& random) {
  LightMap light;
  light.columns = static_cast<std::uint16_t>(pick(random, 1, 6));
  light.rows = static_cast<std::uint16_t>(pick(random, 1, 6));
  for (auto& plane : light.illumination) {
    for (int i = 0; i < light.columns * light.rows; ++i) {
      plane[static_cast<std::size_t>(i)] = static_cast<float>(pick(random, 40, 250)) / 100.0f;
    }
  }
  return light;
}

TEST_F(RegionScannerTest, FindsRegionsWithShadingRegionOfInterestAndLeastSize) {
  for (int round = 0; round < 500; ++round) {
    const auto pattern = kAllPatterns[random_() % kAllPatterns.size()];
    const auto format = kAllFormats[random_() % kAllFormats.size()];
    const int width = round % 4 == 0 ? pick(random_, 96, 128) : pick(random_, 8, 95), height = pick(random_, 8, 18);
    const OwnedPicture picture =
        paint(make_pattern(pattern, width, height, random_), format, pick(random_, 0, 9), random_);
    const Frame frame = picture.frame();
    ScanParameters parameters = parameters_for(frame);
    if (round % 2 == 0) parameters.light = random_light(random_);
    if (round % 3 != 0) {
      for (int i = pick(random_, 3, 12); i > 0; --i) {
        parameters.region_of_interest.push_back({static_cast<float>(pick(random_, -20, 2 * width + 20)) / 2.0f,
                                                 static_cast<float>(pick(random_, -20, 2 * height + 20)) / 2.0f});
      }
      if (scanner_->configure(parameters).code() == ErrorCode::kInconsistent) continue;  // covers no pixel
    }
    parameters.min_area_px = static_cast<std::uint32_t>(pick(random_, 0, 4) * pick(random_, 0, 3));
    parameters.min_height_px = static_cast<std::uint32_t>(pick(random_, 0, 4));
    ASSERT_EQ(difference_on(frame, parameters), "")
        << "round " << round << ", " << name_of(pattern) << ", " << name_of(format) << ", " << width << " x " << height;
  }
}

// Lines that leave the 64 columns in which they touch other rows, to both sides and into the region of interest's edge.
TEST_F(RegionScannerTest, ARowThatIsReadInPartIsReadAsFarAsItsColorsReach) {
  for (int round = 0; round < 300; ++round) {
    ColorGrid grid = make_grid(pick(random_, 130, 330), pick(random_, 3, 6));
    for (int lines = pick(random_, 1, 6); lines > 0; --lines) {
      const int begin = pick(random_, 0, grid.width - 1), v = pick(random_, 0, grid.height - 1);
      const int end = std::min(grid.width, begin + pick(random_, 1, 200));
      const int period = pick(random_, 60, 400);
      for (int u = begin; u < end; ++u) grid.at(u, v) = static_cast<ColorId>(1 + u / period % 2);
    }
    const OwnedPicture picture = paint(grid, kAllFormats[random_() % kAllFormats.size()], 0, random_);
    ScanParameters parameters = parameters_for(picture.frame());
    parameters.min_height_px = 2;
    if (round % 2 == 0) {
      const float left = static_cast<float>(pick(random_, 0, 100)), right = static_cast<float>(grid.width) - 20.5f;
      for (const PixelPoint& corner : {PixelPoint{left, -1}, PixelPoint{right, -1}, PixelPoint{right, 9}}) {
        parameters.region_of_interest.push_back(corner);
      }
    }
    ASSERT_EQ(difference_on(picture.frame(), parameters), "") << "round " << round;
  }
}

TEST_F(RegionScannerTest, ALineIsFollowedThroughAllWordsToBothSides) {
  for (const int touch : {10, 329 / 2, 320}) {
    ColorGrid grid = make_grid(330, 3);
    grid.at(touch, 0) = 1;
    std::fill_n(&grid.at(0, 1), grid.width, ColorId{1});
    const OwnedPicture picture = paint(grid, PixelFormat::kRgb24, 0, random_);
    ScanParameters parameters = parameters_for(picture.frame());
    parameters.min_height_px = 2;
    ASSERT_EQ(difference_on(picture.frame(), parameters), "") << touch;
    ASSERT_EQ(regions_->size(), 1u);
    EXPECT_EQ((*regions_)[0].area_px, 331u);
  }
}

// The tables of both heights in turn, with rows that only one of them reads.
TEST_F(RegionScannerTest, LeastHeightsMayChangeBetweenFrames) {
  const OwnedPicture dense = paint(make_pattern(Pattern::kBlobs, 200, 31, random_), PixelFormat::kNv12, 0, random_);
  ColorGrid line = make_grid(200, 31);
  std::fill_n(&line.at(20, 15), 100, ColorId{2});
  const OwnedPicture low = paint(line, PixelFormat::kNv12, 0, random_);
  ScanParameters parameters = parameters_for(dense.frame());
  ASSERT_TRUE(scanner_->configure(parameters).ok());
  const auto of_two_rows = std::make_unique<ScanTables>();
  parameters.min_height_px = 2;
  ASSERT_TRUE(of_two_rows->configure(parameters).ok());
  const ColorGrid colors = defined_colors(dense.frame(), parameters);
  ScanTables* next = of_two_rows.get();
  for (std::uint32_t round = 0; round < 6; ++round) {
    const std::uint32_t height = 1 + round % 2;
    ASSERT_TRUE(scanner_->scan(dense.frame(), *runs_, *regions_).ok());
    ASSERT_EQ(difference(expected_regions(colors, 1, height), *runs_, *regions_), "") << round;
    ASSERT_TRUE(scanner_->scan(low.frame(), *runs_, *regions_).ok());
    ASSERT_EQ(regions_->size(), height == 1 ? 1u : 0u) << round;
    next = &scanner_->exchange(*next);
  }
}

// After a change of tables, nothing remains of the colors that the former tables found outside of the region of
// interest or in rows that are read in part. With 30 to 32 rows, each of the scanner's rows is the last one of a
// picture once.
TEST_F(RegionScannerTest, NothingRemainsOfScansWithOtherTables) {
  for (const int height : {30, 31, 32}) {
    const OwnedPicture dense =
        paint(make_pattern(Pattern::kBlobs, 330, height, random_), PixelFormat::kRgb24, 0, random_);
    ScanParameters whole = parameters_for(dense.frame()), part = whole;
    part.min_height_px = 2;
    for (const PixelPoint& corner : {PixelPoint{75.0f, -1.0f}, PixelPoint{301.0f, 4.0f}, PixelPoint{150.0f, 40.0f}}) {
      part.region_of_interest.push_back(corner);
    }
    ASSERT_TRUE(scanner_->configure(whole).ok());
    const auto tables_of_part = std::make_unique<ScanTables>();
    ASSERT_TRUE(tables_of_part->configure(part).ok());
    ScanTables* next = tables_of_part.get();
    for (const ScanParameters* parameters : {&whole, &part, &whole, &part}) {
      ASSERT_TRUE(scanner_->scan(dense.frame(), *runs_, *regions_).ok());
      const auto expected = expected_regions(defined_colors(dense.frame(), *parameters), 1, parameters->min_height_px);
      ASSERT_EQ(difference(expected, *runs_, *regions_), "") << height << ", " << parameters->min_height_px;
      next = &scanner_->exchange(*next);
    }
  }
}

TEST_F(RegionScannerTest, FindsRegionsInPicturesOfRandomBytesAndBoxes) {
  for (int round = 0; round < 300; ++round) {
    const auto format = kAllFormats[random_() % kAllFormats.size()];
    OwnedPicture picture(format, pick(random_, 1, 80), pick(random_, 1, 24), pick(random_, 0, 5));
    ScanParameters parameters = parameters_for(picture.frame());
    parameters.boxes = random_boxes(random_, static_cast<std::size_t>(pick(random_, 0, kMaxColorBoxes)));
    picture.fill([&] { return critical_value(random_, parameters.boxes); });
    ASSERT_EQ(difference_on(picture.frame(), parameters), "") << "round " << round << ", " << name_of(format);
  }
}

TEST_F(RegionScannerTest, SumsOfTheLargestRegionAreExact) {
  // All pixels of the largest frame except one in the corner: sums of floats would be wrong by several pixels.
  OwnedPicture picture(PixelFormat::kNv12, kMaxFrameWidth, kMaxFrameHeight, 0);
  picture.fill([] { return std::uint8_t{50}; });
  picture.set(0, 0, {0, 50, 50});
  const Frame frame = picture.frame();
  ASSERT_TRUE(scanner_->configure(parameters_for(frame)).ok());
  ASSERT_TRUE(scanner_->scan(frame, *runs_, *regions_).ok());
  ASSERT_EQ(regions_->size(), 1u);
  const Region& region = (*regions_)[0];
  const double pixels = double{kMaxFrameWidth} * double{kMaxFrameHeight};
  EXPECT_EQ(region.area_px, static_cast<std::uint32_t>(pixels) - 1);
  EXPECT_EQ(region.centroid.u_px, static_cast<float>(pixels * (kMaxFrameWidth - 1) / 2.0 / (pixels - 1.0)));
  EXPECT_EQ(region.centroid.v_px, static_cast<float>(pixels * (kMaxFrameHeight - 1) / 2.0 / (pixels - 1.0)));
  EXPECT_EQ(region.box.right, kMaxFrameWidth - 1);
  EXPECT_EQ(region.box.bottom, kMaxFrameHeight - 1);
}

TEST_F(RegionScannerTest, ARejectedFrameGivesNoRegions) {
  const OwnedPicture picture = paint(make_pattern(Pattern::kBlobs, 64, 48, random_), PixelFormat::kNv12, 0, random_);
  const Frame good = picture.frame();
  EXPECT_EQ(scanner_->scan(good, *runs_, *regions_).code(), ErrorCode::kUnsupported) << "not configured yet";

  const auto status_of = [&](const Frame& frame) {
    EXPECT_TRUE(scanner_->scan(good, *runs_, *regions_).ok());
    EXPECT_FALSE(regions_->empty());
    const ErrorCode code = scanner_->scan(frame, *runs_, *regions_).code();
    EXPECT_TRUE(runs_->empty() && regions_->empty());
    return code;
  };
  ASSERT_TRUE(scanner_->configure(parameters_for(good)).ok());
  Frame frame = good;
  frame.format = PixelFormat::kYuyv;
  EXPECT_EQ(status_of(frame), ErrorCode::kUnsupported);
  frame = good;
  frame.width_px = 63;
  EXPECT_EQ(status_of(frame), ErrorCode::kUnsupported);
  frame = good;
  frame.height_px = 49;
  EXPECT_EQ(status_of(frame), ErrorCode::kUnsupported);
  frame = good;
  frame.plane[1] = nullptr;
  EXPECT_EQ(status_of(frame), ErrorCode::kShortFrame);
  frame = good;
  frame.stride_bytes[0] = 63;
  EXPECT_EQ(status_of(frame), ErrorCode::kShortFrame);
}

TEST_F(RegionScannerTest, RejectsInvalidParameters) {
  ScanParameters parameters = parameters_for(OwnedPicture(PixelFormat::kRgb24, 64, 48, 0).frame());
  ASSERT_TRUE(scanner_->configure(parameters).ok());
  const auto code_of = [&](auto change) {
    ScanParameters changed = parameters;
    change(changed);
    return scanner_->configure(changed).code();
  };
  EXPECT_EQ(code_of([](ScanParameters& p) { p.width_px = 0; }), ErrorCode::kOutOfRange);
  EXPECT_EQ(code_of([](ScanParameters& p) { p.height_px = kMaxFrameHeight + 1; }), ErrorCode::kOutOfRange);
  EXPECT_EQ(code_of([](ScanParameters& p) { p.boxes[0].low[1] = 10, p.boxes[0].high[1] = 9; }), ErrorCode::kOutOfRange);
  EXPECT_EQ(code_of([](ScanParameters& p) { p.light.columns = 1; }), ErrorCode::kOutOfRange);
  EXPECT_EQ(code_of([](ScanParameters& p) {
              for (int i = 0; i < 3; ++i) p.region_of_interest.push_back({-5.0f, -5.0f});
            }),
            ErrorCode::kInconsistent);
  const OwnedPicture picture(PixelFormat::kRgb24, 64, 48, 0);
  EXPECT_EQ(scanner_->scan(picture.frame(), *runs_, *regions_).code(), ErrorCode::kUnsupported)
      << "no frame is accepted after an error";
}

}  // namespace
}  // namespace touchline::testing
