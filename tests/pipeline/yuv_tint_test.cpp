// A change of tint in YUV pictures, in which the tiles of the light map have one level for all channels.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "core/adaptation.h"
#include "tests/color/owned_picture.h"
#include "tests/color/rgb_to_yuv.h"

namespace touchline::testing {
namespace {

using LinearRgb = std::array<double, 3>;

// Red, blue and yellow.
constexpr ColorId kFirstPatch = 1, kLastPatch = 3;
constexpr LinearRgb kFloorRgb{62, 60, 58};
constexpr std::array<LinearRgb, 4> kPatchRgb{{kFloorRgb, {190, 40, 45}, {40, 90, 195}, {185, 170, 35}}};
constexpr int kWide = 320, kHigh = 240, kPatchSide = 12;

Channels yuv_of(const LinearRgb& rgb, ColorSpace space) {
  const auto byte = [](double x) { return static_cast<std::uint8_t>(std::lround(std::clamp(x, 0.0, 255.0))); };
  const auto value = in_space(space, {std::min(rgb[0], 255.0), std::min(rgb[1], 255.0), std::min(rgb[2], 255.0)});
  return {byte(value[0]), byte(value[1]), byte(value[2])};
}

class YuvTint : public ::testing::TestWithParam<PixelFormat> {
 protected:
  void SetUp() override {
    scan_.format = GetParam();
    scan_.width_px = kWide;
    scan_.height_px = kHigh;
    scan_.box_shift_limit = static_cast<std::uint8_t>(max_shift_);
    scan_.light.columns = scan_.light.rows = 1;
    for (auto& plane : scan_.light.illumination) plane[0] = 1.0f;
    parameters_.max_shift = max_shift_;
    for (ColorId color = kFirstPatch; color <= kLastPatch; ++color) {
      const Channels value = yuv_of(kPatchRgb[color], color_space(GetParam()));
      ColorBox box{color, {}, {}};
      for (std::size_t c = 0; c < 3; ++c) {
        box.low[c] = static_cast<std::uint8_t>(value[c] - tolerance_);
        box.high[c] = static_cast<std::uint8_t>(value[c] + tolerance_);
      }
      // Brightness differs more than tint.
      box.low[0] = static_cast<std::uint8_t>(value[0] - 3 * tolerance_);
      box.high[0] = static_cast<std::uint8_t>(value[0] + 3 * tolerance_);
      scan_.boxes.push_back(box);
      parameters_.typical[color] = value;
      parameters_.typical.measured[color] = true;
    }
    const Frame frame = show({1, 1, 1});
    const ReferenceGrid grid = ReferenceGrid::of(kWide, kHigh);
    parameters_.reference.columns = grid.columns;
    parameters_.reference.rows = grid.rows;
    for (std::size_t row = 0; row < grid.rows; ++row) sample_cells(frame, grid, row, parameters_.reference.colors);
  }
  void start(AdaptationMode mode) {
    parameters_.mode = mode;
    ASSERT_TRUE(scanner_->configure(scan_).ok());
    ASSERT_TRUE(adaptation_->configure(parameters_, scan_, kBackground).ok());
    EXPECT_EQ(patches_seen({1, 1, 1}), 3);
  }
  // A floor with a patch of each color.
  Frame show(const LinearRgb& light) {
    for (int v = 0; v < kHigh; ++v) {
      for (int u = 0; u < kWide; ++u) {
        std::size_t color = 0;
        for (std::size_t k = 1; k < kPatchRgb.size(); ++k) {
          const int left = 80 * static_cast<int>(k);
          if (u >= left && u < left + kPatchSide && v >= 100 && v < 100 + kPatchSide) color = k;
        }
        LinearRgb rgb = kPatchRgb[color];
        for (std::size_t c = 0; c < 3; ++c) rgb[c] *= light[c];
        picture_.set(u, v, yuv_of(rgb, color_space(GetParam())));
      }
    }
    return picture_.frame();
  }
  // Number of patches that are one region of their color in the next frame.
  int patches_seen(const LinearRgb& light) {
    const Frame frame = show(light);
    adaptation_->measure(frame, *scanner_);
    EXPECT_TRUE(scanner_->scan(frame, trace_->runs, trace_->regions).ok());
    return static_cast<int>(std::count_if(trace_->regions.begin(), trace_->regions.end(), [](const Region& region) {
      return region.area_px == kPatchSide * kPatchSide &&
             std::abs(region.centroid.u_px - (80.0f * region.color + 5.5f)) < 0.1f;
    }));
  }

  // Full range has 255 steps of chroma, limited range 224.
  const bool is_full_range_ = color_space(GetParam()) == ColorSpace::kYuvFullRange;
  const int tolerance_ = is_full_range_ ? 7 : 6, max_shift_ = is_full_range_ ? 17 : 15;
  ScanParameters scan_;
  AdaptationParameters parameters_;
  OwnedPicture picture_{GetParam(), kWide, kHigh, 0};
  std::unique_ptr<RegionScanner> scanner_ = std::make_unique<RegionScanner>();
  std::unique_ptr<Adaptation> adaptation_ = std::make_unique<Adaptation>();
  std::unique_ptr<StepTrace> trace_ = std::make_unique<StepTrace>();
};

constexpr std::array<LinearRgb, 4> kTints{{{1.15, 1, 0.85}, {0.85, 1, 1.15}, {0.6, 0.5, 0.4}, {1.25, 1.2, 1.05}}};

TEST_P(YuvTint, IsCorrectedInItsFirstFrame) {
  for (const LinearRgb& tint : kTints) {
    start(AdaptationMode::kFollow);
    EXPECT_EQ(patches_seen(tint), 3) << tint[0] << ' ' << tint[1] << ' ' << tint[2];
    EXPECT_EQ(patches_seen({1, 1, 1}), 3) << "and back";
  }
}

TEST_P(YuvTint, WouldLosePatchesWithoutCorrection) {
  for (const LinearRgb& tint : kTints) {
    start(AdaptationMode::kOff);
    EXPECT_LT(patches_seen(tint), 3) << tint[0] << ' ' << tint[1] << ' ' << tint[2];
  }
}

TEST_P(YuvTint, IsForgottenWhenTheAdaptationIsTurnedOff) {
  start(AdaptationMode::kFollow);
  ASSERT_EQ(patches_seen(kTints[0]), 3);
  adaptation_->set_mode(AdaptationMode::kOff);
  for (int i = 0; i < 400; ++i) adaptation_->update(*scanner_, *trace_);
  EXPECT_EQ(patches_seen({1, 1, 1}), 3);
  EXPECT_LT(patches_seen(kTints[0]), 3);
}

INSTANTIATE_TEST_SUITE_P(Formats, YuvTint,
                         ::testing::Values(PixelFormat::kYuyv, PixelFormat::kUyvy, PixelFormat::kNv12,
                                           PixelFormat::kI420, PixelFormat::kYuvj422p),
                         [](const auto& format) { return name_of(format.param); });

}  // namespace
}  // namespace touchline::testing
