#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "core/color/row_classifier.h"
#include "tests/color/owned_picture.h"
#include "tests/color/rgb_to_yuv.h"

// Compares the classification under uneven light with a literal implementation of eq. (17): every pixel is divided by
// its own illumination in double precision, without tiles and without levels.
namespace touchline::testing {
namespace {

// Interpolates bilinearly between cell centers, constant beyond the outermost ones; u and v count from the picture's
// corner.
double illumination(const LightMap& map, std::size_t channel, double u, double v, int width, int height) {
  const auto at = [&](int column, int row) {
    return static_cast<double>(map.illumination[channel][static_cast<std::size_t>(
        std::clamp(row, 0, map.rows - 1) * map.columns + std::clamp(column, 0, map.columns - 1))]);
  };
  const double x = u * map.columns / width - 0.5, y = v * map.rows / height - 0.5;
  const double left = std::floor(x), top = std::floor(y);
  const int column = static_cast<int>(left), row = static_cast<int>(top);
  const double upper = std::lerp(at(column, row), at(column + 1, row), x - left);
  const double lower = std::lerp(at(column, row + 1), at(column + 1, row + 1), x - left);
  return std::lerp(upper, lower, y - top);
}

// Returns the illumination of a channel; in YUV all three channels have that of the luminance (ITU-R BT.601).
double light_of(const LightMap& map, ColorSpace space, std::size_t channel, double u, double v, int width, int height) {
  const auto of = [&](std::size_t c) { return illumination(map, c, u, v, width, height); };
  return space == ColorSpace::kRgb ? of(channel) : 0.299 * of(0) + 0.587 * of(1) + 0.114 * of(2);
}

double dark_value(ColorSpace space, std::size_t channel) { return in_space(space, {0.0, 0.0, 0.0})[channel]; }

struct Interval {
  double low = 255.0, high = 0.0;
  void include(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
};

// Smooth illumination with several maxima and minima, different for each channel.
LightMap hilly_light(std::mt19937& random) {
  LightMap map;
  map.columns = static_cast<std::uint16_t>(pick(random, 3, 20));
  map.rows = static_cast<std::uint16_t>(pick(random, 3, 15));
  for (auto& plane : map.illumination) {
    const double across = pick(random, 0, 600) / 100.0, down = pick(random, 0, 600) / 100.0;
    const double phase = pick(random, 0, 600) / 100.0;
    for (int row = 0; row < map.rows; ++row) {
      for (int column = 0; column < map.columns; ++column) {
        const double hill = std::sin(phase + across * column / map.columns) * std::cos(down * row / map.rows);
        plane[static_cast<std::size_t>(row * map.columns + column)] = static_cast<float>(1.0 + 0.55 * hill);
      }
    }
  }
  return map;
}

class LightCorrectionTest : public ::testing::TestWithParam<PixelFormat> {
 protected:
  // Returns the illumination of a tile, in which the gain is constant.
  Interval light_of_tile(const LightMap& map, const OwnedPicture& picture, std::size_t channel, int column, int row) {
    Interval light;
    for (int y = 0; y <= 2 * kTileHeight; y += 2) {
      for (int x = 0; x <= 2 * kTileWidth; x += 2) {
        light.include(light_of(map, color_space(GetParam()), channel, column * kTileWidth + 0.5 * x,
                               row * kTileHeight + 0.5 * y, picture.width(), picture.height()));
      }
    }
    return light;
  }

  // Returns all results of eq. (17) in this light, within half a level and rounding.
  Interval corrected_values(const Interval& light, std::size_t channel, std::uint8_t value) {
    const double half_step = std::exp2(1.0 / 64.0), dark = dark_value(color_space(GetParam()), channel);
    Interval interval;
    for (const double bound : {light.low, light.high}) {
      for (const double step : {1.0 / half_step, half_step}) {
        const double corrected = dark + (value - dark) / bound * step;
        interval.include(std::clamp(corrected - 0.5, 0.0, 255.0));
        interval.include(std::clamp(corrected + 0.5, 0.0, 255.0));
      }
    }
    // A channel at full scale stands for this light and all brighter light.
    if (value == 255) interval.include(255.0);
    return interval;
  }

  std::unique_ptr<RowClassifier> classifier_ = std::make_unique<RowClassifier>();
  std::mt19937 random_{static_cast<std::uint32_t>(GetParam()) + 40};
};

TEST_P(LightCorrectionTest, AgreesWithEquation17WhereQuantizationDoesNotMatter) {
  std::size_t certain = 0, all = 0, colored = 0;
  for (int round = 0; round < 12; ++round) {
    OwnedPicture picture(GetParam(), pick(random_, 40, 150), pick(random_, 20, 60), pick(random_, 0, 7));
    const Frame frame = picture.frame();
    const ColorBoxes boxes = random_boxes(random_, 6);
    const auto map = std::make_unique<LightMap>(hilly_light(random_));
    ASSERT_TRUE(classifier_->configure(GetParam(), frame.width_px, frame.height_px, boxes, *map).ok());
    picture.fill([&] { return static_cast<std::uint8_t>(random_()); });
    std::vector<ColorId> colors(frame.width_px);
    for (int v = 0; v < picture.height(); v += 3) {
      classifier_->classify(frame, static_cast<std::uint16_t>(v), 0, frame.width_px, colors.data());
      int tile = -1;
      std::array<Interval, 3> light, seen;
      for (int u = v % 2; u < picture.width(); u += 2) {
        const Channels value = channels_at(frame, u, v);
        if (tile != u / kTileWidth) {
          tile = u / kTileWidth;
          for (std::size_t c = 0; c < 3; ++c) light[c] = light_of_tile(*map, picture, c, tile, v / kTileHeight);
        }
        for (std::size_t c = 0; c < 3; ++c) seen[c] = corrected_values(light[c], c, value[c]);
        ColorId expected = kBackground;
        bool is_certain = true;
        for (const ColorBox& box : boxes) {
          bool inside = true, outside = false;
          for (std::size_t c = 0; c < 3; ++c) {
            inside = inside && box.low[c] <= seen[c].low && seen[c].high <= box.high[c];
            outside = outside || seen[c].high < box.low[c] || box.high[c] < seen[c].low;
          }
          if (inside) {
            expected = box.color;
            break;
          }
          is_certain = is_certain && outside;
        }
        ++all;
        if (!is_certain) continue;
        ++certain;
        colored += expected == kBackground ? 0u : 1u;
        ASSERT_EQ(int{colors[static_cast<std::size_t>(u)]}, int{expected})
            << "round " << round << " (" << u << ", " << v << ")";
      }
    }
  }
  EXPECT_GT(certain, all / 2) << "too few pixels have a certain result";
  EXPECT_GT(colored, certain / 20);
}

using Rgb = std::array<double, 3>;

Channels in_format(ColorSpace space, const Rgb& rgb) {
  const Rgb value = in_space(space, rgb);
  Channels out{};
  for (std::size_t c = 0; c < 3; ++c) out[c] = static_cast<std::uint8_t>(std::lround(std::clamp(value[c], 0.0, 255.0)));
  return out;
}

// The paper's claim (section 6.3): colors learned in one light are recognized in another.
TEST_P(LightCorrectionTest, RecognizesColorsInLightFromTwoFifthsToFourThirds) {
  const std::array<Rgb, 6> paints = {
      {{170, 40, 40}, {40, 160, 60}, {50, 60, 170}, {165, 150, 30}, {150, 50, 150}, {90, 90, 90}}};
  const ColorSpace space = color_space(GetParam());
  ColorBoxes boxes;
  for (std::size_t i = 0; i < paints.size(); ++i) {
    const Channels middle = in_format(space, paints[i]);
    ColorBox box;
    box.color = static_cast<ColorId>(i + 1);
    for (std::size_t c = 0; c < 3; ++c) {
      const int extent = is_yuv(space) && c > 0 ? 8 : 12;
      box.low[c] = static_cast<std::uint8_t>(std::max(0, middle[c] - extent));
      box.high[c] = static_cast<std::uint8_t>(middle[c] + extent);
    }
    boxes.push_back(box);
  }

  // Lamps of two colors in opposite corners; for YUV formats, white lamps.
  constexpr int kWidth = 320, kHeight = 240;
  const auto map = std::make_unique<LightMap>();
  map->columns = 32, map->rows = 24;
  for (std::size_t c = 0; c < 3; ++c) {
    for (int i = 0; i < map->columns * map->rows; ++i) {
      const int columns = map->columns;
      const double u = (i % columns + 0.5) / columns, v = (i / columns + 0.5) / map->rows;
      const double along = space == ColorSpace::kRgb && c == 2 ? 1.0 - u : u;
      map->illumination[c][static_cast<std::size_t>(i)] = static_cast<float>(0.4 + 0.6 * along + 0.33 * v);
    }
  }
  OwnedPicture picture(GetParam(), kWidth, kHeight, 0);
  std::vector<ColorId> truth;
  for (int v = 0; v < kHeight; ++v) {
    for (int u = 0; u < kWidth; ++u) {
      const std::size_t paint = static_cast<std::size_t>(u / 20 + v / 14 * 5) % paints.size();
      truth.push_back(static_cast<ColorId>(paint + 1));
      Rgb lit{};
      for (std::size_t c = 0; c < 3; ++c) {
        // Pixels that share chroma have the same illumination.
        lit[c] = paints[paint][c] * illumination(*map, c, u / 2 * 2 + 1.0, v / 2 * 2 + 1.0, kWidth, kHeight);
      }
      picture.set(u, v, in_format(space, lit));
    }
  }

  const auto share_recognized = [&](const LightMap& light) {
    EXPECT_TRUE(classifier_->configure(GetParam(), kWidth, kHeight, boxes, light).ok());
    std::size_t right = 0;
    std::vector<ColorId> colors(kWidth);
    for (int v = 0; v < kHeight; ++v) {
      classifier_->classify(picture.frame(), static_cast<std::uint16_t>(v), 0, kWidth, colors.data());
      for (std::size_t u = 0; u < kWidth; ++u) {
        right += colors[u] == truth[static_cast<std::size_t>(v) * kWidth + u] ? 1u : 0u;
      }
    }
    return static_cast<double>(right) / static_cast<double>(truth.size());
  };
  EXPECT_EQ(share_recognized(*map), 1.0);
  EXPECT_LT(share_recognized(LightMap{}), 0.6) << "the light is not uneven enough to need a correction";
}

INSTANTIATE_TEST_SUITE_P(EveryFormat, LightCorrectionTest, ::testing::ValuesIn(kAllFormats),
                         [](const auto& test) { return std::string(name_of(test.param)); });

}  // namespace
}  // namespace touchline::testing
