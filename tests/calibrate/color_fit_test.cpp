#include "tools/programs/calibrate/colors/color_fit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>

#include "core/region/region_scanner.h"
#include "tests/calibrate/painted_field.h"

namespace touchline::calibrate {
namespace {

double even(int, int) { return 1.0; }
double slope(int u, int) { return 0.75 + 0.5 * u / 320.0; }

const std::vector<std::pair<std::string, std::array<double, 3>>>& palette() {
  static const std::vector<std::pair<std::string, std::array<double, 3>>> colors = {
      {"yellow", {190, 180, 40}}, {"blue", {40, 90, 190}},     {"red", {180, 30, 40}},
      {"green", {30, 150, 60}},   {"magenta", {180, 40, 150}}, {"orange", {195, 100, 25}}};
  return colors;
}

// The picture shows each color three times; `shift` moves the patches to positions with other light.
std::vector<PaintedPatch> arrangement(int shift) {
  std::vector<PaintedPatch> patches;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 6; ++column) {
      const auto& [name, rgb] = palette()[static_cast<std::size_t>((column + 2 * row + shift) % 6)];
      patches.push_back({name, rgb, 35 + 50 * column, 50 + 70 * row});
    }
  }
  return patches;
}

void add_clicks(ColorFitInput& input, const std::string& image, const std::vector<PaintedPatch>& patches) {
  for (const PaintedPatch& p : patches) {
    input.clicks.push_back({image, p.color, static_cast<double>(p.u_px - 2), static_cast<double>(p.v_px + 2)});
  }
}

struct Found {
  std::size_t right = 0, wrong = 0, ghosts = 0;
};

// Returns the share of correct patches according to the pipeline's scanner in another picture: a region of the right
// color covers the patch.
Found recognize(const ColorFitInput& input, const ColorFit& fit, const std::vector<PaintedPatch>& patches,
                const CameraPicture& picture) {
  const auto scanner = std::make_unique<RegionScanner>();
  const auto runs = std::make_unique<Runs>();
  const auto regions = std::make_unique<Regions>();
  const Frame frame = picture.frame();
  ScanParameters parameters;
  parameters.format = frame.format;
  parameters.width_px = frame.width_px;
  parameters.height_px = frame.height_px;
  parameters.boxes = fit.learned.boxes;
  parameters.light = input.light;
  EXPECT_TRUE(scanner->configure(parameters).ok());
  EXPECT_TRUE(scanner->scan(frame, *runs, *regions).ok());
  Found found;
  for (const Region& region : *regions) {
    if (region.area_px < 30) continue;
    bool known = false;
    for (const PaintedPatch& p : patches) {
      if (std::abs(region.centroid.u_px - (static_cast<float>(p.u_px) - 0.5f)) < 1.0f &&
          std::abs(region.centroid.v_px - (static_cast<float>(p.v_px) - 0.5f)) < 1.0f) {
        known = true;
        ++(fit.names[region.color - 1U] == p.color ? found.right : found.wrong);
      }
    }
    if (!known) ++found.ghosts;
  }
  return found;
}

class ColorFitOf : public ::testing::TestWithParam<PixelFormat> {};

TEST_P(ColorFitOf, ColorsFromOnePictureAreFoundInAnother) {
  ColorFitInput input;
  const std::vector<PaintedPatch> patches = arrangement(0);
  input.pictures["a"] = painted_field(patches, GetParam(), 1, slope);
  add_clicks(input, "a", patches);
  Result<ColorFit> fitted = fit_colors(input);
  ASSERT_TRUE(fitted.ok()) << fitted.text();
  ColorFit fit = std::move(fitted).value();
  ASSERT_EQ(fit.names.size(), 6U);
  EXPECT_TRUE(fit.strays.empty());
  std::size_t first = 0, second = 0;
  EXPECT_FALSE(overlapping_boxes(fit.learned.boxes, first, second));
  for (std::size_t c = 0; c < 6; ++c) {
    EXPECT_GT(fit.confusion[c][c + 1], 0.95) << fit.names[c];
    EXPECT_LT(fit.background_share[c], 1e-3) << fit.names[c];
  }
  for (const ClickResult& click : fit.clicks) {
    EXPECT_GE(click.area_px, 100U);
    EXPECT_LE(click.area_px, 190U);  // 12 x 12 and some of the blurred edge
  }
  const std::vector<PaintedPatch> others = arrangement(3);
  const Found found = recognize(input, fit, others, painted_field(others, GetParam(), 99, slope));
  EXPECT_EQ(found.right, others.size());
  EXPECT_EQ(found.wrong, 0U);
  EXPECT_EQ(found.ghosts, 0U);
}

INSTANTIATE_TEST_SUITE_P(Formats, ColorFitOf,
                         ::testing::Values(PixelFormat::kRgb24, PixelFormat::kYuyv, PixelFormat::kI420,
                                           PixelFormat::kXrgb8888));

// A place that a layout predicts is the inner part of a patch, and real patches may be larger than the layout says.
TEST(ColorFit, WhatContinuesAPatchIsNoBackground) {
  const std::vector<PaintedPatch> patches = arrangement(0);
  const auto least_room = [&](int half_px) {
    ColorFitInput input;
    input.pictures["a"] = painted_field(patches, PixelFormat::kRgb24, 1, even);
    for (const PaintedPatch& p : patches) {
      Click click{"a", p.color, static_cast<double>(p.u_px), static_cast<double>(p.v_px), 0, {}};
      for (int v = p.v_px - half_px; v < p.v_px + half_px; ++v) {
        for (int u = p.u_px - half_px; u < p.u_px + half_px; ++u)
          click.pixels.push_back(static_cast<std::size_t>(v) * input.pictures["a"].frame().width_px +
                                 static_cast<std::size_t>(u));
      }
      input.clicks.push_back(click);
    }
    const Result<ColorFit> fit = fit_colors(input);
    EXPECT_TRUE(fit.ok()) << fit.text();
    int least = 255;
    for (const ColorBox& box : fit.value().learned.boxes) {
      for (std::size_t c = 0; c < 3; ++c) least = std::min(least, box.high[c] - box.low[c]);
    }
    return least;
  };
  const int whole = least_room(5), inner = least_room(2);
  EXPECT_GT(whole, 40);
  EXPECT_GT(inner, whole - 10) << "of 12 pixels, 2 to 4 are sampled";
}

// Each picture shows every color three times. With few patches, colors of teams and the ball get boxes for other light;
// 15 patches of a team show the light on the field, and suffice for a ball with fewer patches, too.
TEST(ColorFit, ManyPatchesNeedNoBoxesForOtherLight) {
  const auto boxes_with = [](int pictures, std::map<std::string, ColorUse> uses) {
    ColorFitInput input;
    input.uses = std::move(uses);
    for (int i = 0; i < pictures; ++i) {
      const std::string image = std::to_string(i);
      std::vector<PaintedPatch> patches = arrangement(i);
      if (i > 0)
        patches.erase(std::remove_if(patches.begin(), patches.end(),
                                     [](const PaintedPatch& patch) { return patch.color == "orange"; }),
                      patches.end());
      input.pictures[image] = painted_field(patches, PixelFormat::kRgb24, static_cast<unsigned>(i), even);
      add_clicks(input, image, patches);
    }
    const Result<ColorFit> fit = fit_colors(input);
    EXPECT_TRUE(fit.ok()) << fit.text();
    return fit.value().learned.boxes.size();
  };
  const std::map<std::string, ColorUse> team = {{"blue", ColorUse::kTeam}}, ball = {{"orange", ColorUse::kBall}};
  EXPECT_GT(boxes_with(1, team), boxes_with(1, {}));
  EXPECT_GT(boxes_with(1, ball), boxes_with(1, {}));
  EXPECT_EQ(boxes_with(5, team), boxes_with(5, {}));
  EXPECT_EQ(boxes_with(5, ball), boxes_with(5, {}));
}

TEST(ColorFit, ColorsFromOneCornerSufficeWithALightMap) {
  // Colors learned in bright light only must be found in a third of the light.
  const auto lamp = [](int u, int) { return u < 160 ? 1.2 : 0.4; };
  std::vector<PaintedPatch> bright, dark;
  for (int i = 0; i < 6; ++i) {
    const auto& [name, rgb] = palette()[static_cast<std::size_t>(i)];
    bright.push_back({name, rgb, 30 + 50 * (i % 3), 60 + 100 * (i / 3)});
    dark.push_back({name, rgb, 190 + 50 * (i % 3), 60 + 100 * (i / 3)});
  }
  ColorFitInput input;
  input.pictures["a"] = painted_field(bright, PixelFormat::kRgb24, 1, lamp);
  add_clicks(input, "a", bright);
  const CameraPicture other = painted_field(dark, PixelFormat::kRgb24, 2, lamp);
  Result<ColorFit> fitted = fit_colors(input);
  ASSERT_TRUE(fitted.ok()) << fitted.text();
  ColorFit fit = std::move(fitted).value();
  EXPECT_LE(recognize(input, fit, dark, other).right, 2U);

  input.light.columns = 20;
  input.light.rows = 1;
  for (std::size_t i = 0; i < 20; ++i) {
    for (auto& channel : input.light.illumination) channel[i] = i < 10 ? 1.2f : 0.4f;
  }
  fitted = fit_colors(input);
  ASSERT_TRUE(fitted.ok()) << fitted.text();
  fit = std::move(fitted).value();
  const Found found = recognize(input, fit, dark, other);
  EXPECT_EQ(found.right, 6U);
  EXPECT_EQ(found.wrong, 0U);
  // The expected floor is that at illumination 1, not that of the visible half.
  ASSERT_TRUE(fit.background.has_value());
  for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR((*fit.background)[c], (std::array{45, 48, 50})[c], 2);
}

TEST(ColorFit, SaysWhyAClickSelectedNoPatch) {
  ColorFitInput input;
  const std::vector<PaintedPatch> patches = arrangement(0);
  input.pictures["a"] = painted_field(patches, PixelFormat::kRgb24, 1, even);
  add_clicks(input, "a", patches);
  const std::size_t good = input.clicks.size();
  input.clicks.push_back({"a", "red", 10, 225});  // the floor
  input.clicks.push_back({"a", "red", 400, 20});
  input.clicks.push_back({"b", "red", 40, 40});
  Result<ColorFit> fitted = fit_colors(input);
  ASSERT_TRUE(fitted.ok()) << fitted.text();
  ColorFit fit = std::move(fitted).value();
  for (std::size_t i = 0; i < good; ++i) EXPECT_GT(fit.clicks[i].area_px, 0U) << i;
  EXPECT_EQ(fit.clicks[good].area_px, 0U);
  EXPECT_NE(fit.clicks[good].reason.find("larger than a patch"), std::string::npos) << fit.clicks[good].reason;
  EXPECT_NE(fit.clicks[good + 1].reason.find("outside the picture"), std::string::npos);
  EXPECT_NE(fit.clicks[good + 2].reason.find("missing"), std::string::npos);
  // The boxes must not include the floor.
  for (const double share : fit.background_share) EXPECT_LT(share, 1e-3);
}

TEST(ColorFit, RejectsAColorWithoutAUsableClick) {
  ColorFitInput input;
  const std::vector<PaintedPatch> patches = arrangement(0);
  input.pictures["a"] = painted_field(patches, PixelFormat::kRgb24, 1, even);
  add_clicks(input, "a", patches);
  input.clicks.push_back({"a", "cyan", 10, 225});
  const Result<ColorFit> fitted = fit_colors(input);
  EXPECT_EQ(fitted.code(), ErrorCode::kNotFound);
  EXPECT_NE(fitted.text().find("cyan"), std::string::npos) << fitted.text();
}

TEST(ColorFit, NamesColorsThatCannotBeDistinguished) {
  ColorFitInput input;
  const std::vector<PaintedPatch> patches = arrangement(0);
  input.pictures["a"] = painted_field(patches, PixelFormat::kRgb24, 1, even);
  add_clicks(input, "a", patches);
  bool odd = false;
  for (Click& click : input.clicks) {
    if (click.color == "green" && (odd = !odd)) click.color = "mint";  // the same paint under two names
  }
  const Result<ColorFit> fitted = fit_colors(input);
  if (fitted.ok()) {
    const ColorFit& fit = fitted.value();
    // The colors are separated at some level; the report must show that they cannot be distinguished.
    const PairMargin& closest = fit.learned.margins.front();
    EXPECT_LT(closest.levels, 0);
    EXPECT_TRUE((fit.names[closest.first] == "green" && fit.names[closest.second] == "mint") ||
                (fit.names[closest.first] == "mint" && fit.names[closest.second] == "green"));
    double lost = 0;
    for (std::size_t c = 0; c < fit.names.size(); ++c) lost = std::max(lost, 1.0 - fit.confusion[c][c + 1]);
    EXPECT_GT(lost, 0.3);
  } else {
    EXPECT_EQ(fitted.code(), ErrorCode::kInconsistent);
    EXPECT_NE(fitted.text().find("green"), std::string::npos) << fitted.text();
    EXPECT_NE(fitted.text().find("mint"), std::string::npos) << fitted.text();
  }
}

TEST(ColorFit, ReportsPatchesWithoutAClickAndExcludesThemFromTheBackground) {
  ColorFitInput input;
  const std::vector<PaintedPatch> patches = arrangement(0);
  input.pictures["a"] = painted_field(patches, PixelFormat::kRgb24, 1, even);
  add_clicks(input, "a", {patches.begin(), patches.begin() + 6});  // only the first row
  Result<ColorFit> fitted = fit_colors(input);
  ASSERT_TRUE(fitted.ok()) << fitted.text();
  ColorFit fit = std::move(fitted).value();
  EXPECT_EQ(fit.strays.size(), 12U);
  const std::vector<PaintedPatch> others = arrangement(3);
  const Found found = recognize(input, fit, others, painted_field(others, PixelFormat::kRgb24, 99, even));
  EXPECT_EQ(found.right, others.size());
  EXPECT_EQ(found.wrong + found.ghosts, 0U);
}

TEST(ColorFit, Distinguishes24Colors) {
  // Four values per channel, without grey and similar colors.
  std::vector<PaintedPatch> patches, others;
  for (const int r : {40, 120, 200}) {
    for (const int g : {40, 120, 200}) {
      for (const int b : {40, 120, 200}) {
        if (r == g && g == b) continue;
        const int i = static_cast<int>(patches.size());
        const std::array<double, 3> rgb{static_cast<double>(r), static_cast<double>(g), static_cast<double>(b)};
        const std::string name = "c" + std::to_string(i);
        patches.push_back({name, rgb, 25 + 52 * (i % 6), 40 + 52 * (i / 6)});
        others.push_back({name, rgb, 25 + 52 * ((i + 7) % 24 % 6), 40 + 52 * ((i + 7) % 24 / 6)});
      }
    }
  }
  ASSERT_EQ(patches.size(), 24U);
  ColorFitInput input;
  input.pictures["a"] = painted_field(patches, PixelFormat::kRgb24, 1, even);
  add_clicks(input, "a", patches);
  Result<ColorFit> fitted = fit_colors(input);
  ASSERT_TRUE(fitted.ok()) << fitted.text();
  ColorFit fit = std::move(fitted).value();
  const Found found = recognize(input, fit, others, painted_field(others, PixelFormat::kRgb24, 9, even));
  EXPECT_EQ(found.right, 24U);
  EXPECT_EQ(found.wrong + found.ghosts, 0U);
}

TEST(ColorFit, SuggestsAPaintForOneOfTwoSimilarColors) {
  ColorFitInput input;
  std::vector<PaintedPatch> patches = arrangement(0);
  for (PaintedPatch& p : patches) {
    if (p.color == "magenta") p = {"maroon", {170, 25, 60}, p.u_px, p.v_px};  // close to red
  }
  input.pictures["a"] = painted_field(patches, PixelFormat::kRgb24, 1, even);
  add_clicks(input, "a", patches);
  Result<ColorFit> fitted = fit_colors(input);
  ASSERT_TRUE(fitted.ok()) << fitted.text();
  ColorFit fit = std::move(fitted).value();
  ASSERT_EQ(fit.advice.replacements.size(), 1U);
  const ColorReplacement& replacement = fit.advice.replacements[0];
  const std::set<std::string> pair{fit.names[replacement.first], fit.names[replacement.second]};
  EXPECT_EQ(pair, (std::set<std::string>{"red", "maroon"}));
  EXPECT_LT(replacement.levels, 20);
  EXPECT_GT(replacement.suggestion.levels, 35) << replacement.suggestion.name;
  EXPECT_EQ(std::count(fit.names.begin(), fit.names.end(), replacement.suggestion.name), 0);
}

TEST(ColorFit, RefusesPicturesOfDifferentSizes) {
  ColorFitInput input;
  const std::vector<PaintedPatch> patches = arrangement(0);
  input.pictures["a"] = painted_field(patches, PixelFormat::kRgb24, 1, even);
  input.pictures["b"] = painted_field(patches, PixelFormat::kYuyv, 1, even);
  add_clicks(input, "a", patches);
  const Result<ColorFit> fitted = fit_colors(input);
  EXPECT_EQ(fitted.code(), ErrorCode::kInconsistent);
}

}  // namespace
}  // namespace touchline::calibrate
