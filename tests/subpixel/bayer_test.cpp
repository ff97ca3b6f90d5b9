// What a Bayer pattern does to the edges of patches, and how it is recognized.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/subpixel/bayer_detector.h"
#include "core/subpixel/bayer_sampling.h"
#include "tests/color/owned_picture.h"
#include "tests/marker/portable_random.h"

namespace touchline::testing {
namespace {

constexpr int kWidth = 320, kHeight = 240;

// What a sensor delivers of a gray floor: noise of some 8-bit steps, interpolated bilinearly if `red_column` is 0 or 1.
// `columns` is how many neighbors in a row share red and blue.
OwnedPicture floor(PixelFormat format, PortableRandom& dice, float sigma, int red_column, int columns = 1,
                   int red_row = 0) {
  std::vector<std::array<float, 3>> measured(kWidth * kHeight);
  for (auto& pixel : measured) {
    for (float& value : pixel) value = 90.0f + sigma * std::sqrt(3.0f) * dice.real(-1.0f, 1.0f);
  }
  const auto at = [&](int u, int v, std::size_t c) {
    u = std::clamp(u, 0, kWidth - 1) / columns * columns;
    return measured[static_cast<std::size_t>(std::clamp(v, 0, kHeight - 1) * kWidth + u)][c];
  };
  OwnedPicture picture(format, kWidth, kHeight, 0);
  for (int v = 0; v < kHeight; ++v) {
    for (int u = 0; u < kWidth; ++u) {
      Channels out{};
      for (std::size_t c = 0; c < 3; ++c) {
        float value = at(u, v, c);
        if (red_column >= 0 && c != 1) {
          const int across = (u + red_column + (c == 2 ? 1 : 0)) % 2, down = (v + red_row + (c == 2 ? 1 : 0)) % 2;
          value = 0.25f * (at(u - across, v - down, c) + at(u + across, v - down, c) + at(u - across, v + down, c) +
                           at(u + across, v + down, c));
        }
        out[c] = static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0f, 255.0f)));
      }
      picture.set(u, v, out);
    }
  }
  return picture;
}

TEST(BayerDetector, FindsThePatternInSinglePicturesOfOrdinaryNoise) {
  PortableRandom dice(11);
  for (const PixelFormat format : {PixelFormat::kRgb24, PixelFormat::kBgr24, PixelFormat::kXrgb8888}) {
    for (const int red : {0, 1, 2, 3}) {
      const int column = red % 2, row = red / 2;
      for (const float sigma : {1.0f, 2.0f, 3.0f}) {
        BayerDetector detector;
        detector.examine(floor(format, dice, sigma, column, 1, row).frame());
        EXPECT_TRUE(detector.pattern().found) << red << ' ' << sigma;
        EXPECT_EQ(detector.pattern().red_column, column) << sigma;
        EXPECT_EQ(detector.pattern().red_row, row) << sigma;
      }
    }
  }
}

TEST(BayerDetector, FindsNoneWithoutThePattern) {
  PortableRandom dice(12);
  BayerDetector detector;
  for (const float sigma : {0.0f, 0.3f, 1.0f, 3.0f}) {
    for (const int columns : {1, 2}) {
      for (int n = 0; n < 8; ++n) {
        const OwnedPicture picture = floor(PixelFormat::kRgb24, dice, sigma, -1, columns);
        BayerDetector fresh;
        fresh.examine(picture.frame());
        EXPECT_FALSE(fresh.pattern().found) << sigma << ' ' << columns;
        detector.examine(picture.frame());
        EXPECT_FALSE(detector.pattern().found) << sigma << ' ' << columns;
      }
    }
  }
}

TEST(BayerDetector, ForgetsACameraThatWasReplaced) {
  PortableRandom dice(13);
  BayerDetector detector;
  for (int n = 0; n < 20; ++n) detector.examine(floor(PixelFormat::kRgb24, dice, 2.0f, 0).frame());
  EXPECT_TRUE(detector.pattern().found);
  for (int n = 0; n < 60; ++n) detector.examine(floor(PixelFormat::kRgb24, dice, 2.0f, -1).frame());
  EXPECT_FALSE(detector.pattern().found);
  detector.examine(floor(PixelFormat::kYuyv, dice, 2.0f, 0).frame());
  EXPECT_FALSE(detector.pattern().found) << "YUV shares chroma";
}

// A square that is turned out of the pixel grid has far smaller errors, and one along the diagonal those of the other
// lattice vectors.
TEST(BayerSampling, DependsOnTheAngleOfTheEdges) {
  const BlurredOutline square(PatchPlace{PatchRole::kTeam, PatchOutline::kSquare, 0, 0, 0.0345f, 0.0345f, 0});
  const auto at = [&](float degrees) {
    const float angle = degrees * std::numbers::pi_v<float> / 180.0f;
    return bayer_sampling(square, {std::cos(angle), std::sin(angle)}, 290.0f);
  };
  const BayerSampling along = at(0), turned = at(12), diagonal = at(45);
  // Two edges with independent errors of 0.032 pixels.
  EXPECT_NEAR(along.grid.x, 0.5f * 0.032f * 0.032f, 0.00003f);
  EXPECT_LT(turned.grid.x, 0.2f * along.grid.x);
  EXPECT_LT(diagonal.grid.x, 0.02f * along.grid.x);
  EXPECT_GT(diagonal.diagonal.x, 20.0f * along.diagonal.x);
  EXPECT_NEAR(at(90).grid.x, along.grid.x, 1e-6f);
  EXPECT_NEAR(at(-8).grid.y, at(8).grid.y, 1e-6f);
  // A circle does not depend on the angle, and averages less than a turned square.
  const BlurredOutline circle(PatchPlace{PatchRole::kTeam, PatchOutline::kCircle, 0, 0, 0.0345f, 0.0345f, 0});
  const float of_circle = bayer_sampling(circle, {1, 0}, 290.0f).grid.x;
  EXPECT_NEAR(bayer_sampling(circle, {0.7f, 0.7f}, 290.0f).grid.x, of_circle, 1e-7f);
  EXPECT_GT(of_circle, diagonal.grid.x);
  EXPECT_LT(of_circle, along.grid.x);
}

TEST(ChannelWeights, HaveTheLeastVariance) {
  const BayerSampling sampling{{0.01f, 0.01f}, {0.001f, 0.001f}};
  PortableRandom dice(14);
  const auto variance = [&](const std::array<float, 3>& weights, const std::array<float, 3>& noise) {
    float sum = sampling_variance(sampling, weights).x;
    for (std::size_t c = 0; c < 3; ++c) sum += weights[c] * weights[c] * noise[c];
    return sum;
  };
  for (int n = 0; n < 200; ++n) {
    std::array<float, 3> noise;
    for (float& value : noise) value = std::pow(10.0f, dice.real(-6.0f, 2.0f));
    const std::array<float, 3> best = channel_weights(sampling, noise);
    EXPECT_NEAR(best[0] + best[1] + best[2], 1.0f, 1e-5f);
    for (int other = 0; other < 20; ++other) {
      const float red = dice.real(-0.3f, 0.3f), blue = dice.real(-0.3f, 0.3f);
      const std::array<float, 3> changed{best[0] + red, best[1] - red - blue, best[2] + blue};
      EXPECT_GE(variance(changed, noise), variance(best, noise) * (1.0f - 1e-4f));
    }
  }
  // Red and blue of little noise count alike, because their errors cancel.
  const std::array<float, 3> magenta = channel_weights(sampling, {1e-5f, 10.0f, 1e-4f});
  EXPECT_NEAR(magenta[0], 0.5f, 0.03f);
  EXPECT_NEAR(magenta[2], 0.5f, 0.03f);
  // Without a pattern, each color counts in proportion to 1 / its variance.
  const std::array<float, 3> plain = channel_weights({}, {1.0f, 0.5f, 0.25f});
  EXPECT_NEAR(plain[0], 1.0f / 7.0f, 1e-5f);
  EXPECT_NEAR(plain[2], 4.0f / 7.0f, 1e-5f);
}

}  // namespace
}  // namespace touchline::testing
