#include "core/marker/border_color.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/marker/color_evidence.h"
#include "tests/color/owned_picture.h"

namespace touchline::testing {
namespace {

using Values = std::array<float, 3>;

constexpr Values kPinkValue{250, 187, 199}, kLavenderValue{205, 200, 244}, kWhiteValue{240, 240, 240};
constexpr Values kBlackTop{45, 45, 45}, kYellowSide{250, 240, 70};
constexpr float kMiddle = 40.3f, kHalfSide = 6.4f, kInner = 3.0f, kReach = 14.0f;

std::uint8_t byte_of(float linear) {
  return static_cast<std::uint8_t>(std::lround(std::min(255.0f, std::sqrt(linear))));
}

// A patch on a robot's top (Gamma 2), blurred by the lens before it saturates. `beside`: the top's color on the left
// side of the patch.
OwnedPicture patch_in_light(const Values& paint, float gain, const Values& beside = kBlackTop) {
  OwnedPicture picture(PixelFormat::kRgb24, 80, 80, 0);
  const auto covered = [](float distance) { return 0.5f * std::erfc(distance / 1.4f); };
  for (int v = 0; v < 80; ++v) {
    for (int u = 0; u < 80; ++u) {
      const float du = std::abs(static_cast<float>(u) - kMiddle), dv = std::abs(static_cast<float>(v) - kMiddle);
      const float patch = covered(du - kHalfSide) * covered(dv - kHalfSide);
      const Values& top = u < 32 ? beside : kBlackTop;
      Channels value{};
      for (std::size_t c = 0; c < 3; ++c) {
        value[c] = byte_of(gain * gain * (patch * paint[c] * paint[c] + (1 - patch) * top[c] * top[c]));
      }
      picture.set(u, v, value);
    }
  }
  return picture;
}

class SaturatedPatch : public ::testing::Test {
 protected:
  enum Paint : ColorId { kPink = 1, kLavender };
  SaturatedPatch() {
    TypicalColors typical;
    typical[kPink] = {250, 187, 199};
    typical[kLavender] = {205, 200, 244};
    typical.measured[kPink] = typical.measured[kLavender] = true;
    evidence.configure(typical);
  }
  [[nodiscard]] float likelihood(Paint paint) const {
    LocalLight light;
    light.gain = {1.4f, 1.4f, 1.4f};
    light.ratio_variance = 0.08f * 0.08f;
    return evidence.log_likelihood_of_border(border, light, paint, ColorSpace::kRgb);
  }

  const SurfaceColor all{.saturated = {true, true, true}};
  ColorEvidence evidence;
  BorderColor border;
};

TEST_F(SaturatedPatch, HasItsRatiosOfChannelsAtItsBorder) {
  for (const Values& paint : {kPinkValue, kLavenderValue}) {
    const OwnedPicture picture = patch_in_light(paint, 1.4f);
    const auto middle = pixel_at(picture.frame(), 40, 40);
    ASSERT_EQ(middle, (std::array<std::uint8_t, 3>{255, 255, 255}));
    ASSERT_TRUE(sample_border(picture.frame(), {kMiddle, kMiddle}, all, kInner, kReach, border));
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t next = (c + 1) % 3;
      const auto excess = [&](std::size_t i) { return paint[i] * paint[i] - kBlackTop[i] * kBlackTop[i]; };
      EXPECT_NEAR(std::log(border.excess[c] / border.excess[next]), std::log(excess(c) / excess(next)), 0.1f) << c;
      EXPECT_NEAR(std::sqrt(border.background[c]), 1.4f * kBlackTop[c], 3.0f);
    }
  }
}

TEST_F(SaturatedPatch, IsNamedByItsBorder) {
  ASSERT_TRUE(sample_border(patch_in_light(kPinkValue, 1.4f).frame(), {kMiddle, kMiddle}, all, kInner, kReach, border));
  EXPECT_GT(likelihood(kPink), likelihood(kLavender) + 2.0f);
  ASSERT_TRUE(
      sample_border(patch_in_light(kLavenderValue, 1.4f).frame(), {kMiddle, kMiddle}, all, kInner, kReach, border));
  EXPECT_GT(likelihood(kLavender), likelihood(kPink) + 2.0f);
}

// A side that another patch touches does not count.
TEST_F(SaturatedPatch, IsNamedBesideABrightPatch) {
  ASSERT_TRUE(sample_border(patch_in_light(kPinkValue, 1.4f, kYellowSide).frame(), {kMiddle, kMiddle}, all, kInner,
                            kReach, border));
  EXPECT_GT(likelihood(kPink), likelihood(kLavender) + 2.0f);
}

// A camera that saturates before it interpolates its mosaic shows less contrast. Both patches look like pink then, but
// one of them more than the other.
TEST_F(SaturatedPatch, IsNamedBesideAnotherOneInSpiteOfLowContrast) {
  const auto of_robot = [](const Values& linear) {
    BorderOfRobot out;
    out.border = {linear, {0.05f, 0.05f, 0.05f}, {3000, 3000, 3000}};
    out.light.gain = {1.4f, 1.4f, 1.4f};
    out.light.ratio_variance = 0.08f * 0.08f;
    return out;
  };
  const BorderOfRobot pink = of_robot({1.32f, 0.78f, 0.90f}), lavender = of_robot({1.14f, 0.83f, 1.03f});
  const auto likelihood = [&](const BorderOfRobot& seen, Paint paint) {
    return evidence.log_likelihood_of_border(seen.border, seen.light, paint, ColorSpace::kRgb);
  };
  ASSERT_GT(likelihood(lavender, kPink), likelihood(lavender, kLavender)) << "low contrast";
  const auto order = [&](Paint left, Paint right) {
    return evidence.log_likelihood_of_order(pink, left, lavender, right, ColorSpace::kRgb);
  };
  const float alone = likelihood(pink, kPink) - likelihood(pink, kLavender) + likelihood(lavender, kLavender) -
                      likelihood(lavender, kPink);
  EXPECT_GT(order(kPink, kLavender), 1.3f * alone);
  EXPECT_FLOAT_EQ(order(kLavender, kPink), -order(kPink, kLavender));
  // Equal patches have no order.
  EXPECT_NEAR(evidence.log_likelihood_of_order(pink, kPink, pink, kLavender, ColorSpace::kRgb), 0.0f, 0.01f);
}

TEST_F(SaturatedPatch, HasNoBorderInWhiteSurroundings) {
  OwnedPicture picture = patch_in_light(kPinkValue, 1.4f);
  for (int v = 0; v < 80; ++v) {
    for (int u = 0; u < 80; ++u) {
      if (std::max(std::abs(u - 40), std::abs(v - 40)) > 6) picture.set(u, v, {230, 230, 230});
    }
  }
  EXPECT_FALSE(sample_border(picture.frame(), {kMiddle, kMiddle}, all, kInner, kReach, border));
  // All pixels are saturated, or none is in the picture.
  picture.fill([] { return std::uint8_t{255}; });
  EXPECT_FALSE(sample_border(picture.frame(), {kMiddle, kMiddle}, all, kInner, kReach, border));
  EXPECT_FALSE(sample_border(picture.frame(), {-5.0f, 400.0f}, all, kInner, kReach, border));
}

// A line of the field is as white as a saturated patch, but narrower.
TEST_F(SaturatedPatch, IsNoLine) {
  OwnedPicture picture = patch_in_light(kWhiteValue, 1.4f);
  for (int v = 0; v < 80; ++v) {
    for (int u = 0; u < 80; ++u) {
      const bool is_line = u > 38 && u < 43;
      const bool is_border = u == 38 || u == 43;
      const auto value = static_cast<std::uint8_t>(is_line ? 255 : is_border ? 180 : 60);
      picture.set(u, v, {value, value, value});
    }
  }
  EXPECT_FALSE(sample_border(picture.frame(), {kMiddle, kMiddle}, all, kInner, kReach, border));
}

}  // namespace
}  // namespace touchline::testing
