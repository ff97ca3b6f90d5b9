#include "tools/programs/relight/changed_picture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "tests/replay/media.h"
#include "tools/programs/relight/changed_series.h"

namespace touchline::relight {
namespace {

hal::Picture plain(std::uint8_t red, std::uint8_t green, std::uint8_t blue) {
  hal::Picture picture;
  picture.width_px = 40;
  picture.height_px = 24;
  for (int i = 0; i < 40 * 24; ++i) picture.rgb8.insert(picture.rgb8.end(), {red, green, blue});
  return picture;
}

std::array<int, 3> pixel(const hal::Picture& picture, std::size_t u, std::size_t v) {
  const std::uint8_t* rgb = &picture.rgb8[3 * (v * picture.width_px + u)];
  return {rgb[0], rgb[1], rgb[2]};
}

using Rgb = std::array<int, 3>;

TEST(ChangedPicture, HalfTheLightIsHalfBehindTheGammaOfTheCamera) {
  const hal::Picture half = changed(plain(200, 100, 0), {.light = 0.5});
  // 0.5^(1/2.2) = 0.730
  EXPECT_EQ(pixel(half, 3, 3), (Rgb{146, 73, 0}));
  EXPECT_EQ(pixel(changed(plain(200, 100, 0), {.light = 2.0}), 3, 3), (Rgb{255, 137, 0}));
}

TEST(ChangedPicture, TheShadowCoversTheLeftHalf) {
  const hal::Picture picture = changed(plain(200, 100, 50), {.shadow = 0.35});
  // 0.35^(1/2.2) = 0.6206
  EXPECT_EQ(pixel(picture, 19, 5), (Rgb{124, 62, 31}));
  EXPECT_EQ(pixel(picture, 20, 5), (Rgb{200, 100, 50}));
}

TEST(ChangedPicture, EachChannelHasItsFactorAndIsClipped) {
  EXPECT_EQ(pixel(changed(plain(240, 100, 100), {.values = {1.15, 1.0, 0.85}}), 0, 0), (Rgb{255, 100, 85}));
}

TEST(ChangedPicture, ABlurHasItsStandardDeviation) {
  hal::Picture picture = plain(0, 0, 0);
  for (std::size_t u = 20; u < 40; ++u) {
    for (std::size_t v = 0; v < 24; ++v) picture.rgb8[3 * (v * 40 + u)] = 200;
  }
  const hal::Picture blurred = changed(picture, {.blur_px = 1.5});
  // The edge becomes the Gaussian's integral: the square of its slope's standard deviation, from the differences.
  double sum = 0, mean = 0, square = 0;
  for (std::size_t u = 8; u < 32; ++u) {
    const double slope = pixel(blurred, u, 12)[0] - pixel(blurred, u - 1, 12)[0];
    sum += slope;
    mean += slope * static_cast<double>(u);
    square += slope * static_cast<double>(u * u);
  }
  EXPECT_NEAR(sum, 200, 1);
  EXPECT_NEAR(std::sqrt(square / sum - mean / sum * mean / sum), 1.5, 0.1);
}

TEST(ChangedPicture, CompressionKeepsPlainColorsAndLosesDetails) {
  const hal::Picture even = changed(plain(180, 60, 90), {.jpeg_quality = 60});
  const Rgb seen = pixel(even, 12, 12);
  for (std::size_t channel = 0; channel < 3; ++channel) EXPECT_NEAR(seen[channel], (Rgb{180, 60, 90})[channel], 6);

  // Stripes of one pixel in the color only: gone, because color has half the columns.
  hal::Picture stripes = plain(200, 80, 80);
  for (std::size_t i = 0; i < stripes.rgb8.size() / 3; i += 2) stripes.rgb8[3 * i + 2] = 200;
  const hal::Picture compressed = changed(stripes, {.jpeg_quality = 60});
  EXPECT_LT(std::abs(pixel(compressed, 10, 10)[2] - pixel(compressed, 11, 10)[2]), 40);

  // A lower quality changes more.
  hal::Picture texture = plain(100, 100, 100);
  for (std::size_t i = 0; i < texture.rgb8.size(); ++i) {
    texture.rgb8[i] = static_cast<std::uint8_t>(100 + i / 3 * 7 % 32);
  }
  const auto difference = [&texture](int quality) {
    const hal::Picture out = changed(texture, {.jpeg_quality = quality});
    double sum = 0;
    for (std::size_t i = 0; i < out.rgb8.size(); ++i) sum += std::abs(out.rgb8[i] - texture.rgb8[i]);
    return sum / static_cast<double>(out.rgb8.size());
  };
  EXPECT_LT(difference(100), 1.5);
  EXPECT_GT(difference(60), 1.5);
  EXPECT_GT(difference(20), 1.2 * difference(60));
}

TEST(ChangedSeries, WritesEveryNthPictureAndNeverOverItsInput) {
  const media::Folder folder;
  const std::filesystem::path in = std::filesystem::path(folder.path()) / "in",
                              out = std::filesystem::path(folder.path()) / "out";
  std::filesystem::create_directory(in);
  for (const char* name : {"a.png", "b.png", "c.png"}) {
    ASSERT_TRUE(hal::write_picture((in / name).string(), plain(200, 100, 0)).ok());
  }
  const Result<std::uint64_t> written = change_series(in.string(), out.string(), {.light = 0.5}, {}, 2);
  ASSERT_TRUE(written.ok()) << written.text();
  EXPECT_EQ(written.value(), 2U);
  EXPECT_FALSE(std::filesystem::exists(out / "b.png"));
  const Result<hal::Picture> picture = hal::read_picture((out / "c.png").string());
  ASSERT_TRUE(picture.ok()) << picture.text();
  EXPECT_EQ(pixel(picture.value(), 0, 0), (Rgb{146, 73, 0}));

  EXPECT_EQ(change_series(in.string(), in.string(), {.light = 0.5}, {}, 1).code(), ErrorCode::kInconsistent);
  const Result<hal::Picture> kept = hal::read_picture((in / "a.png").string());
  ASSERT_TRUE(kept.ok()) << kept.text();
  EXPECT_EQ(pixel(kept.value(), 0, 0), (Rgb{200, 100, 0}));
}

// Two floors of which the right one has half the light. A paper like a pixel on the left has half its light on the
// right.
TEST(PaintedThings, HaveTheLightOfTheFloorAroundThem) {
  hal::Picture picture;
  picture.width_px = 400;
  picture.height_px = 120;
  for (int i = 0; i < 400 * 120; ++i) {
    const std::uint8_t level = i % 400 < 200 ? 100 : 73;  // 0.5^(1/2.2) = 0.730
    picture.rgb8.insert(picture.rgb8.end(), {level, level, level});
  }
  for (std::size_t v = 50; v < 60; ++v) {
    for (std::size_t u = 60; u < 70; ++u) picture.rgb8[3 * (v * 400 + u)] = 200;
  }
  Thing paper;
  paper.u_px = 320;
  paper.v_px = 60;
  paper.size_px = 20;
  paper.colors = {{.like_pixel = true, .pixel = {65, 55}, .rgb = {}}};
  paint({paper}, picture);
  const auto near = [](int a, int b) { return std::abs(a - b) <= 6; };  // noise of 1.2 levels
  EXPECT_TRUE(near(pixel(picture, 320, 60)[0], 146)) << pixel(picture, 320, 60)[0];
  EXPECT_TRUE(near(pixel(picture, 320, 60)[1], 73)) << pixel(picture, 320, 60)[1];
  EXPECT_EQ(pixel(picture, 340, 60), (Rgb{73, 73, 73})) << "beside the paper";
}

// A lamp's image adds the same light to every surface.
TEST(PaintedThings, GlareAddsLight) {
  hal::Picture picture;
  picture.width_px = 100;
  picture.height_px = 50;
  for (int i = 0; i < 100 * 50; ++i) {
    const std::uint8_t level = i % 100 < 50 ? 100 : 200;
    picture.rgb8.insert(picture.rgb8.end(), {level, 0, 255});
  }
  Thing glare;
  glare.kind = ThingKind::kGlare;
  glare.u_px = 50;
  glare.v_px = 25;
  glare.size_px = 20;
  glare.light = 0.15;
  paint({glare}, picture);
  // 255 (0.15 + (value / 255)^2.2)^(1 / 2.2)
  EXPECT_EQ(pixel(picture, 49, 25), (Rgb{142, 108, 255}));
  EXPECT_EQ(pixel(picture, 50, 25), (Rgb{222, 108, 255}));
  EXPECT_EQ(pixel(picture, 70, 25), (Rgb{200, 0, 255})) << "two radii away";
}

TEST(PaintedThings, FileWithAnUnknownKindIsRefusedByName) {
  const std::filesystem::path file = std::filesystem::path(::testing::TempDir()) / "things.json";
  {
    std::ofstream out(file);
    out << R"({"a.png": [{"kind": "paper", "u": 1, "v": 2, "size": 3, "colors": [{"rgb": [1, 2, 3]}]}]})";
  }
  const Result<Things> read = read_things(file.string());
  ASSERT_TRUE(read.ok()) << read.text();
  EXPECT_EQ(read.value().at("a.png").at(0).colors.at(0).rgb[2], 3);
  {
    std::ofstream out(file);
    out << R"({"a.png": [{"kind": "cat", "u": 1, "v": 2, "size": 3, "colors": [{"rgb": [1, 2, 3]}]}]})";
  }
  EXPECT_EQ(read_things(file.string()).code(), ErrorCode::kInconsistent);
  {
    std::ofstream out(file);
    out << R"({"a.png": [{"kind": "glare", "u": 1, "v": 2, "size": 3}]})";
  }
  EXPECT_EQ(read_things(file.string()).code(), ErrorCode::kInconsistent) << "glare without light";
}

}  // namespace
}  // namespace touchline::relight
