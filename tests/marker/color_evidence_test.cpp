#include "core/marker/color_evidence.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace touchline::testing {
namespace {

using Values = std::array<float, 3>;

enum Paint : ColorId { kYellowPaint = 1, kBluePaint, kPinkPaint, kLavenderPaint, kBrownPaint, kGreenPaint, kPaints };

constexpr std::array<std::array<std::uint8_t, 3>, kPaints> kPaintValues{
    {{}, {220, 200, 45}, {40, 90, 205}, {235, 140, 160}, {170, 150, 215}, {120, 85, 50}, {20, 150, 95}}};

class PaintedPatches : public ::testing::Test {
 protected:
  PaintedPatches() {
    TypicalColors typical;
    for (std::size_t paint = 1; paint < kPaints; ++paint) {
      typical[paint] = kPaintValues[paint];
      typical.measured[paint] = true;
    }
    evidence.configure(typical);
  }

  // Returns the camera's values of a patch. `glare`: share of the lamps' light that the patch reflects like a mirror.
  [[nodiscard]] SurfaceColor seen(ColorId paint, const Values& gain, float glare = 0.0f) const {
    SurfaceColor out;
    for (std::size_t c = 0; c < 3; ++c) {
      const float white = gain[c] * 255.0f, diffuse = gain[c] * static_cast<float>(kPaintValues[paint][c]);
      // Gamma 2.
      const float value = std::sqrt(diffuse * diffuse + glare * white * white);
      out.rgb[c] = std::min(value, full_scale);
      out.saturated[c] = value >= full_scale;
    }
    return out;
  }
  // Returns how much likelier the paint is than each other identification color, and than no known color.
  [[nodiscard]] float margin(ColorId paint, const SurfaceColor& patch, const LocalLight& light,
                             ColorId box = kBackground) const {
    float best = ColorEvidence::kNoColor;
    for (ColorId other = kPinkPaint; other < kPaints; ++other) {
      if (other != paint) best = std::max(best, likelihood(patch, light, other, box));
    }
    return likelihood(patch, light, paint, box) - best;
  }
  [[nodiscard]] float likelihood(const SurfaceColor& patch, const LocalLight& light, ColorId paint, ColorId box) const {
    // Each paint is tested in a lane of its own, beside other paints.
    const std::size_t lane = paint % 4;
    ExpectedColors4 expected;
    Simd4<std::int32_t> in_box{};
    for (std::size_t i = 0; i < 4; ++i) {
      const ColorId here = i == lane ? paint : static_cast<ColorId>((paint + 1 + i) % kPaints);
      expected.set(i,
                   evidence.expected_color(light, here == kBackground ? ColorId{kBluePaint} : here, ColorSpace::kRgb));
      in_box[i] = here == box ? -1 : 0;
    }
    return ColorEvidence::log_likelihoods(patch, expected, light.glare, in_box)[lane];
  }
  [[nodiscard]] LocalLight light(const SurfaceColor& team_patch, ColorId team_paint,
                                 const LightPrior& prior = {}) const {
    return evidence.light_on(team_patch, team_paint, ColorSpace::kRgb, prior);
  }
  static LightPrior field(const Values& gain) { return {gain, 0.2f, 0.1f}; }

  ColorEvidence evidence;
  float full_scale = 255.0f;
};

constexpr float kClear = 3.0f;  // 20 to 1

TEST_F(PaintedPatches, AreUnderTheLightOfTheTeamPatch) {
  for (const Values& gain : {Values{1, 1, 1}, Values{0.5f, 0.4f, 0.3f}, Values{1.1f, 1.1f, 1.15f}}) {
    const LocalLight found = light(seen(kBluePaint, gain), kBluePaint);
    for (std::size_t c = 1; c < 3; ++c) EXPECT_NEAR(found.gain[c], gain[c], 0.1f * gain[c]);
  }
}

// With one stop more light, two channels of yellow are saturated, and the third contains little information.
TEST_F(PaintedPatches, AreKnownBesideASaturatedTeamPatchIfTheFieldShowsTheLight) {
  const Values gain{1.37f, 1.37f, 1.37f};
  const SurfaceColor team_patch = seen(kYellowPaint, gain);
  ASSERT_TRUE(team_patch.saturated[0] && team_patch.saturated[1]);
  const LocalLight found = light(team_patch, kYellowPaint, field(gain));
  for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(found.gain[c], gain[c], 0.05f * gain[c]);
  for (ColorId paint = kPinkPaint; paint < kPaints; ++paint) {
    EXPECT_GT(margin(paint, seen(paint, gain), found), kClear) << int{paint};
  }
}

TEST_F(PaintedPatches, ASaturatedTeamPatchIsALowerBoundOfTheLight) {
  const SurfaceColor team_patch = seen(kYellowPaint, {1.37f, 1.37f, 1.37f});
  // The field gives a weaker prior, because the robot is under a lamp.
  const LocalLight brighter = light(team_patch, kYellowPaint, field({0.8f, 0.8f, 0.8f}));
  EXPECT_GT(brighter.gain[0], 1.05f);
  // The bounds add no information if the field is already brighter.
  const LocalLight bright = light(team_patch, kYellowPaint, field({1.5f, 1.5f, 1.5f}));
  EXPECT_GT(bright.gain[0], 1.4f);
}

TEST_F(PaintedPatches, MayStandInAShadowThatTheFieldDoesNotShow) {
  const Values gain{0.5f, 0.5f, 0.5f};
  const LocalLight found = light(seen(kBluePaint, gain), kBluePaint, field({1, 1, 1}));
  for (std::size_t c = 1; c < 3; ++c) EXPECT_NEAR(found.gain[c], 0.5f, 0.05f);
  for (ColorId paint = kPinkPaint; paint < kPaints; ++paint) {
    EXPECT_GT(margin(paint, seen(paint, gain), found), kClear) << int{paint};
  }
}

// Without a region of the right color, a whitened patch looks like another paint, unless the team patch is whitened as
// well.
TEST_F(PaintedPatches, AreWhitenedByTheGlareOnTheTeamPatch) {
  const Values gain{1, 1, 1};
  constexpr float kGlare = 0.12f;
  const LocalLight matt = light(seen(kBluePaint, gain), kBluePaint, field(gain));
  const LocalLight glossy = light(seen(kBluePaint, gain, kGlare), kBluePaint, field(gain));
  EXPECT_EQ(matt.glare, 0.0f);
  EXPECT_NEAR(glossy.glare, kGlare, 0.05f);
  float least_matt = kClear;
  for (ColorId paint = kPinkPaint; paint < kPaints; ++paint) {
    const SurfaceColor patch = seen(paint, gain, kGlare);
    least_matt = std::min(least_matt, margin(paint, patch, matt));
    EXPECT_GT(margin(paint, patch, glossy), 1.0f) << int{paint};
  }
  EXPECT_LT(least_matt, 0.0f) << "glare confuses some of them";
}

// The remaining channels decide; a saturated one only excludes colors that are darker.
TEST_F(PaintedPatches, ASaturatedChannelIsALowerBound) {
  const LocalLight found = light(seen(kBluePaint, {1, 1, 1}), kBluePaint, field({1, 1, 1}));
  SurfaceColor patch = seen(kPinkPaint, {1, 1, 1});
  const float exact = likelihood(patch, found, kPinkPaint, kBackground);
  patch.rgb[0] = 150;
  const float darker = likelihood(patch, found, kPinkPaint, kBackground);
  EXPECT_LT(darker, exact - kClear);
  patch.saturated[0] = true;
  const float at_least = likelihood(patch, found, kPinkPaint, kBackground);
  EXPECT_GT(at_least, darker + kClear);
  // A bound is weaker evidence than the exact value.
  EXPECT_LT(at_least, exact);
  // A color that is certainly darker than the bound.
  patch.rgb[0] = 250;
  EXPECT_LT(likelihood(patch, found, kGreenPaint, kBackground), ColorEvidence::kNoColor);
}

// The camera's full scale is below that of the pixel format.
TEST_F(PaintedPatches, MirrorALampWhereTheirRegionHasTheirColor) {
  for (const float scale : {255.0f, 218.0f}) {
    full_scale = scale;
    const Values gain{1, 1, 1};
    const LocalLight found = light(seen(kBluePaint, gain), kBluePaint, field(gain));
    for (const float glare : {0.0f, 0.05f, 0.1f, 0.2f}) {
      for (ColorId paint = kPinkPaint; paint < kPaints; ++paint) {
        SurfaceColor patch = seen(paint, gain, glare);
        // It is not known that 218 is saturated.
        patch.saturated = {};
        if (glare < 0.15f) {
          EXPECT_GT(margin(paint, patch, found, paint), 0.0f) << int{paint} << ", glare " << glare;
        }
        // Other colors of the team are not likelier than no color unless they look alike.
        if (paint == kGreenPaint) {
          EXPECT_GT(margin(paint, patch, found, paint), kClear) << glare;
          EXPECT_LT(likelihood(patch, found, kBrownPaint, paint), ColorEvidence::kNoColor) << glare;
        }
      }
    }
    // Glare brightens the dark channels of the team patch, too.
    const LocalLight glaring = light(seen(kBluePaint, gain, 0.1f), kBluePaint, field(gain));
    EXPECT_GT(margin(kGreenPaint, seen(kGreenPaint, gain, 0.1f), glaring, kGreenPaint), kClear);
  }
}

TEST_F(PaintedPatches, AGraySurfaceIsNoPaintThatMirrorsALamp) {
  const LocalLight found = light(seen(kBluePaint, {1, 1, 1}), kBluePaint, field({1, 1, 1}));
  for (const float value : {30.0f, 60.0f, 90.0f, 130.0f, 180.0f, 230.0f}) {
    SurfaceColor gray;
    gray.rgb = {value, value, value};
    // Pink and lavender are nearly gray without a lamp.
    for (const ColorId paint : {kBrownPaint, kGreenPaint}) {
      EXPECT_LT(likelihood(gray, found, paint, kBackground), ColorEvidence::kNoColor + 0.5f) << int{paint} << value;
    }
  }
}

}  // namespace
}  // namespace touchline::testing
