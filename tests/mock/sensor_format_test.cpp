// All formats compared pixel by pixel with an independent floating-point conversion: ITU-R BT.601.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <vector>

#include "hal/mock/random.h"
#include "hal/mock/renderer.h"
#include "hal/mock/sensor.h"

namespace touchline::hal::mock {
namespace {

struct Size {
  std::uint16_t width, height;
};

SensorParameters clean_sensor() {
  SensorParameters parameters;
  parameters.read_noise_electrons = 0.0;
  parameters.full_well_electrons = 1e7;
  return parameters;
}

std::vector<std::uint16_t> colorful(Size size, std::uint64_t seed) {
  Random random(seed, 7);
  std::vector<std::uint16_t> linear(std::size_t{3} * size.width * size.height);
  for (std::uint16_t& value : linear) value = static_cast<std::uint16_t>(random.uniform(0.0, kLinearScale + 1.0));
  return linear;
}

// The noise depends only on the seed, so RGB serves as the reference for all formats.
std::vector<std::uint8_t> expose(PixelFormat format, Size size, const std::vector<std::uint16_t>& linear) {
  const PictureLayout layout = picture_layout(format, size.width, size.height);
  std::vector<std::uint8_t> out(layout.bytes + 16, 0xA5);
  Sensor(clean_sensor(), format, size.width, size.height, 1).expose(linear, {out.data(), layout.bytes});
  for (std::size_t i = layout.bytes; i < out.size(); ++i) EXPECT_EQ(out[i], 0xA5) << "wrote beyond the buffer";
  out.resize(layout.bytes);
  return out;
}

struct Yuv {
  double y, u, v;
};
// By definition: luma weights 0.299, 0.587, 0.114; 219 luma steps from 16, 224 chroma steps around 128. Full range: 255
// steps each, luma from 0.
Yuv bt601(const std::uint8_t* rgb, bool full_range = false) {
  const double r = rgb[0] / 255.0, g = rgb[1] / 255.0, b = rgb[2] / 255.0;
  const double y = 0.299 * r + 0.587 * g + 0.114 * b;
  if (full_range) return {255.0 * y, 128.0 + 255.0 * (b - y) / 1.772, 128.0 + 255.0 * (r - y) / 1.402};
  return {16.0 + 219.0 * y, 128.0 + 224.0 * (b - y) / (2.0 * (1.0 - 0.114)),
          128.0 + 224.0 * (r - y) / (2.0 * (1.0 - 0.299))};
}

class Formats : public ::testing::TestWithParam<Size> {
 protected:
  [[nodiscard]] const std::uint8_t* pixel(std::size_t column, std::size_t row) const {
    return &rgb_[3 * (row * size_.width + column)];
  }
  // Mean over those pixels of a block that lie inside the picture.
  [[nodiscard]] Yuv block(std::size_t column, std::size_t row, std::size_t rows, bool full_range = false) const {
    Yuv sum{0.0, 0.0, 0.0};
    int count = 0;
    for (std::size_t r = row; r < std::min<std::size_t>(row + rows, size_.height); ++r) {
      for (std::size_t c = column; c < std::min<std::size_t>(column + 2, size_.width); ++c) {
        const Yuv one = bt601(pixel(c, r), full_range);
        sum = {sum.y + one.y, sum.u + one.u, sum.v + one.v};
        ++count;
      }
    }
    return {sum.y / count, sum.u / count, sum.v / count};
  }
  static void expect_luma(std::uint8_t value, double expected) { EXPECT_NEAR(value, expected, 0.51); }
  // Each pixel and then the mean is rounded: two errors of half a step.
  static void expect_chroma(std::uint8_t value, double expected) { EXPECT_NEAR(value, expected, 1.01); }

  const Size size_ = GetParam();
  const std::vector<std::uint16_t> linear_ = colorful(size_, 3);
  const std::vector<std::uint8_t> rgb_ = expose(PixelFormat::kRgb24, size_, linear_);
};

TEST_P(Formats, RgbFollowsTheGammaCurve) {
  ASSERT_EQ(rgb_.size(), linear_.size());
  for (std::size_t i = 0; i < rgb_.size(); ++i) {
    ASSERT_NEAR(rgb_[i], 255.0 * std::pow(linear_[i] / static_cast<double>(kLinearScale), 1.0 / 2.2), 6.0) << i;
  }
}

TEST_P(Formats, BgrIsReversedRgb) {
  const auto bgr = expose(PixelFormat::kBgr24, size_, linear_);
  ASSERT_EQ(bgr.size(), rgb_.size());
  for (std::size_t i = 0; i < rgb_.size(); i += 3) {
    ASSERT_EQ(bgr[i], rgb_[i + 2]);
    ASSERT_EQ(bgr[i + 1], rgb_[i + 1]);
    ASSERT_EQ(bgr[i + 2], rgb_[i]);
  }
}

TEST_P(Formats, YuyvAndUyvyShareChromaByPairs) {
  const auto yuyv = expose(PixelFormat::kYuyv, size_, linear_), uyvy = expose(PixelFormat::kUyvy, size_, linear_);
  const std::size_t stride = picture_layout(PixelFormat::kYuyv, size_.width, size_.height).stride_bytes[0];
  EXPECT_EQ(stride, 4U * ((size_.width + 1U) / 2U));
  for (std::size_t row = 0; row < size_.height; ++row) {
    for (std::size_t column = 0; column < size_.width; ++column) {
      const std::size_t at = row * stride + 2 * column;
      expect_luma(yuyv[at], bt601(pixel(column, row)).y);
      if (column % 2 != 0) continue;
      const Yuv pair = block(column, row, 1);
      expect_chroma(yuyv[at + 1], pair.u);
      expect_chroma(yuyv[at + 3], pair.v);
    }
    for (std::size_t k = 0; k < stride; k += 2) {
      ASSERT_EQ(uyvy[row * stride + k], yuyv[row * stride + k + 1]);
      ASSERT_EQ(uyvy[row * stride + k + 1], yuyv[row * stride + k]);
    }
  }
}

TEST_P(Formats, Nv12SharesChromaByBlocks) {
  const auto nv12 = expose(PixelFormat::kNv12, size_, linear_);
  const PictureLayout layout = picture_layout(PixelFormat::kNv12, size_.width, size_.height);
  EXPECT_EQ(layout.offset_bytes[1], std::size_t{size_.width} * size_.height);
  for (std::size_t row = 0; row < size_.height; ++row) {
    for (std::size_t column = 0; column < size_.width; ++column) {
      expect_luma(nv12[row * layout.stride_bytes[0] + column], bt601(pixel(column, row)).y);
      if (row % 2 != 0 || column % 2 != 0) continue;
      const std::size_t at = layout.offset_bytes[1] + row / 2 * layout.stride_bytes[1] + column;
      const Yuv mean = block(column, row, 2);
      expect_chroma(nv12[at], mean.u);
      expect_chroma(nv12[at + 1], mean.v);
    }
  }
}

TEST_P(Formats, Xrgb8888HasTheSamplesOfRgb24) {
  const auto xrgb = expose(PixelFormat::kXrgb8888, size_, linear_);
  ASSERT_EQ(xrgb.size(), rgb_.size() / 3 * 4);
  for (std::size_t i = 0; i < rgb_.size() / 3; ++i) {
    for (std::size_t c = 0; c < 3; ++c) ASSERT_EQ(xrgb[4 * i + 2 - c], rgb_[3 * i + c]);
  }
}

TEST_P(Formats, I420HasTheSamplesOfNv12) {
  const auto nv12 = expose(PixelFormat::kNv12, size_, linear_), i420 = expose(PixelFormat::kI420, size_, linear_);
  ASSERT_EQ(i420.size(), nv12.size());
  const std::size_t luma = std::size_t{size_.width} * size_.height, chroma = (nv12.size() - luma) / 2;
  for (std::size_t i = 0; i < luma; ++i) ASSERT_EQ(i420[i], nv12[i]);
  for (std::size_t i = 0; i < chroma; ++i) {
    ASSERT_EQ(i420[luma + i], nv12[luma + 2 * i]);
    ASSERT_EQ(i420[luma + chroma + i], nv12[luma + 2 * i + 1]);
  }
}

TEST_P(Formats, Yuvj422pHasFullRangeAndSharesChromaByPairs) {
  const auto yuv = expose(PixelFormat::kYuvj422p, size_, linear_);
  const std::size_t luma = std::size_t{size_.width} * size_.height, pairs = (size_.width + 1U) / 2U;
  ASSERT_EQ(yuv.size(), luma + 2 * pairs * size_.height);
  for (std::size_t row = 0; row < size_.height; ++row) {
    for (std::size_t column = 0; column < size_.width; ++column) {
      expect_luma(yuv[row * size_.width + column], bt601(pixel(column, row), true).y);
      if (column % 2 != 0) continue;
      const std::size_t at = luma + row * pairs + column / 2;
      const Yuv pair = block(column, row, 1, true);
      expect_chroma(yuv[at], pair.u);
      expect_chroma(yuv[at + pairs * size_.height], pair.v);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Sizes, Formats, ::testing::Values(Size{64, 48}, Size{33, 18}, Size{18, 33}, Size{17, 17}),
                         [](const auto& size) {
                           return std::to_string(size.param.width) + "x" + std::to_string(size.param.height);
                         });

TEST(Range, IsThatOfTheFormat) {
  const Size size{16, 16};
  for (const auto& [light, luma, full_luma] : {std::tuple{0, 16, 0}, {kLinearScale, 235, 255}}) {
    const std::vector<std::uint16_t> linear(std::size_t{3} * 16 * 16, static_cast<std::uint16_t>(light));
    const auto yuvj = expose(PixelFormat::kYuvj422p, size, linear);
    EXPECT_NEAR(yuvj[0], full_luma, 1);
    EXPECT_EQ(yuvj[256], 128);
    EXPECT_EQ(yuvj[384], 128);
    const auto yuyv = expose(PixelFormat::kYuyv, size, linear);
    // White can be one step lower, because noise is clipped at full scale.
    EXPECT_NEAR(yuyv[0], luma, 1);
    EXPECT_EQ(yuyv[1], 128);
    EXPECT_EQ(yuyv[3], 128);
  }
}

}  // namespace
}  // namespace touchline::hal::mock
