#include "tools/programs/latency/stress_pattern_camera.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <numbers>

#include "core/region/region_scanner.h"
#include "tests/results.h"

namespace touchline::latency {
namespace {

class StandingClock final : public hal::Clock {
 public:
  [[nodiscard]] Instant now() const override { return Instant(from_seconds(3.0)); }
  void sleep_until(Instant) override {}
};

PipelineParameters parameters_for(PixelFormat format, std::uint16_t width, std::uint16_t height) {
  PipelineParameters parameters;
  parameters.scan.format = format;
  parameters.scan.width_px = width;
  parameters.scan.height_px = height;
  // Five colors; the first box contains the default background color, so another one must be found.
  for (std::uint8_t i = 0; i < 5; ++i) {
    const auto low = static_cast<std::uint8_t>(40 * i);
    parameters.scan.boxes.push_back(
        {static_cast<ColorId>(i + 1), {low, 100, 100}, {static_cast<std::uint8_t>(low + 30), 160, 160}});
  }
  FullModelParameters& lens = parameters.camera.full;
  lens.fx_px = lens.fy_px = 0.8f * static_cast<float>(width);
  lens.cx_px = 0.5f * static_cast<float>(width), lens.cy_px = 0.5f * static_cast<float>(height);
  lens.rotation_rad = {std::numbers::pi_v<float>, 0.0f, 0.0f};
  lens.position_m = {0.0f, 0.0f, 0.5f};
  for (std::size_t team = 0; team < 2; ++team) {
    parameters.marker.teams[team].layout = paper_layout();
    parameters.marker.teams[team].team_color = static_cast<ColorId>(team + 1);
  }
  return parameters;
}

class StressPatterns : public ::testing::TestWithParam<PixelFormat> {};

// Each pattern must cause the work that it claims; otherwise the latency report is too optimistic.
TEST_P(StressPatterns, PatternsCauseTheWorkThatTheyClaim) {
  constexpr std::uint16_t kWidth = 48, kHeight = 48;  // all runs fit into the budget
  const PipelineParameters parameters = parameters_for(GetParam(), kWidth, kHeight);
  const StandingClock clock;
  StressPatternCamera camera(parameters, clock);
  ASSERT_TRUE(camera.open().ok() && camera.start().ok());
  const auto scanner = std::make_unique<RegionScanner>();
  ASSERT_TRUE(scanner->configure(parameters.scan).ok());
  const auto runs = std::make_unique<Runs>();
  const auto regions = std::make_unique<Regions>();
  // In YUV two pixels share their chroma, in 4:2:0 2 x 2.
  const std::size_t column = color_space(GetParam()) == ColorSpace::kRgb ? 1 : 2;
  const std::size_t row = std::size_t{1} << info_of(GetParam()).channel[1].shift_v;
  for (std::uint32_t pattern = 0; pattern < StressPatternCamera::kPatterns; ++pattern) {
    const Result<hal::FrameLease> lease = camera.wait(Instant::max());
    ASSERT_TRUE(lease.ok());
    EXPECT_EQ(lease.value().frame().sequence, pattern);
    EXPECT_EQ(lease.value().frame().capture_time, clock.now());
    ASSERT_TRUE(scanner->scan(lease.value().frame(), *runs, *regions).ok());
    switch (pattern) {
      case 0:
        EXPECT_EQ(regions->size(), 1u);
        EXPECT_EQ((*regions)[0].area_px, std::uint32_t{kWidth} * kHeight);
        break;
      case 1:
        EXPECT_EQ(runs->size(), std::size_t{kWidth} * kHeight / column);
        break;
      case 2:
        EXPECT_EQ(regions->size(), std::size_t{kWidth} * kHeight / (4 * column * row));
        break;
      case 3:
        EXPECT_EQ(regions->size(), 1u);
        EXPECT_GE(runs->size(), std::size_t{kWidth} * (kHeight - 2) / (2 * column));
        break;
      case 4:
        EXPECT_GT(runs->size(), std::size_t{kWidth} * kHeight / (column * 2));
        break;
      case 5:
        EXPECT_EQ(regions->size(), std::size_t{kWidth} * kHeight / (9 * column * row));
        EXPECT_GE((*regions)[0].area_px, 4u);
        break;
      case 6:
        EXPECT_GT(runs->size(), std::size_t{kWidth} * kHeight / 4);
        for (const Region& region : *regions) ASSERT_GE(region.area_px, 2u);
        break;
      case 7: {
        EXPECT_GT(runs->size(), std::size_t{kWidth} * kHeight / (5 * column));
        std::uint32_t largest = 0;
        for (const Region& region : *regions) largest = std::max(largest, region.area_px);
        EXPECT_GT(largest, std::uint32_t{kWidth} * kHeight / 6) << "one cluster spans the picture";
        break;
      }
      default:
        EXPECT_GE(regions->size(), std::size_t{kWidth / 12} * (kHeight / 12));
    }
  }
  for (const NamedClutter& clutter : worst_clutter()) {
    const Result<hal::FrameLease> lease = camera.wait(Instant::max());
    ASSERT_TRUE(lease.ok() && scanner->scan(lease.value().frame(), *runs, *regions).ok()) << clutter.name;
    EXPECT_GT(regions->size(), 5u) << clutter.name;
  }
}
INSTANTIATE_TEST_SUITE_P(Formats, StressPatterns,
                         ::testing::Values(PixelFormat::kRgb24, PixelFormat::kBgr24, PixelFormat::kYuyv,
                                           PixelFormat::kUyvy, PixelFormat::kNv12, PixelFormat::kI420,
                                           PixelFormat::kXrgb8888, PixelFormat::kYuvj422p));

TEST(StressPatternCamera, NeedsColors) {
  PipelineParameters parameters = parameters_for(PixelFormat::kRgb24, 16, 16);
  parameters.scan.boxes.clear();
  const StandingClock clock;
  StressPatternCamera camera(parameters, clock);
  const Result<void> opened = camera.open();
  EXPECT_EQ(opened.code(), ErrorCode::kInconsistent);
  EXPECT_NE(opened.text().find("no colors"), std::string::npos);
}

}  // namespace
}  // namespace touchline::latency
