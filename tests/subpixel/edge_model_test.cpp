#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>

#include "core/subpixel/edge_width.h"
#include "core/subpixel/simd/prerequisites.h"
#include "tests/marker/portable_random.h"

#define TOUCHLINE_SIMD portable
#include "core/subpixel/simd/kernel_functions.h"
#undef TOUCHLINE_SIMD

namespace touchline::testing {
namespace {

using namespace portable;

TEST(LinearLight, HasTheExponent2_2) {
  for (const int value : {0, 1, 16, 60, 128, 200, 254, 255}) {
    const Float8 light = linear_light(broadcast_integer(value));
    EXPECT_NEAR(static_cast<double>(horizontal_sum(light)) / kLanes, std::pow(value / 255.0, 2.2), 3e-4);
  }
}

// Compares the derivatives with finite differences, at a different place in each lane.
TEST(BlurredOutline, SlopesAreItsDerivatives) {
  constexpr float kRamp = 0.008f, kStep = 2e-5f;
  PortableRandom random(5);
  for (const PatchOutline outline :
       {PatchOutline::kSquare, PatchOutline::kBar, PatchOutline::kTriangle, PatchOutline::kCircle}) {
    const PatchPlace place{PatchRole::kTeam, outline, 0, 0, 0.05f, 0.03f, 0.6f};
    const BlurredOutline cover(place);
    int edges = 0, kinks = 0;
    double area = 0;
    for (int n = 0; n < 1000; ++n) {
      StoredFloat8 x, y;
      for (std::size_t i = 0; i < kLanes; ++i) {
        x.value[i] = random.real(-0.05f, 0.05f);
        y.value[i] = random.real(-0.05f, 0.05f);
      }
      const auto stored = [](Float8 lanes) {
        StoredFloat8 out;
        store(lanes, out);
        return out.value;
      };
      const auto value = [&](float dx, float dy) {
        return coverage_at(cover, load(x) + broadcast(dx), load(y) + broadcast(dy), kRamp).value;
      };
      const Coverage here = coverage_at(cover, load(x), load(y), kRamp);
      const auto covered = stored(here.value), slope_x = stored(here.by_x_m), slope_y = stored(here.by_y_m);
      const auto by_x = stored((value(-kStep, 0) - value(kStep, 0)) / broadcast(2 * kStep));
      const auto by_y = stored((value(0, -kStep) - value(0, kStep)) / broadcast(2 * kStep));
      const auto wider = [&](float factor) { return coverage_at(cover, load(x), load(y), factor * kRamp).value; };
      const auto by_width = stored((wider(1.01f) - wider(1 / 1.01f)) / broadcast(2 * std::log(1.01f)));
      const auto slope_width = stored(here.by_width);
      for (std::size_t i = 0; i < kLanes; ++i) {
        area += static_cast<double>(covered[i]) * 0.01 / (kLanes * 1000);
        const FieldPoint box = cover.half_box(kRamp), inner = cover.inner_box(kRamp);
        const float away_x = std::abs(x.value[i]), away_y = std::abs(y.value[i]);
        if (away_x > box.x_m || away_y > box.y_m) {
          EXPECT_LE(covered[i], outline == PatchOutline::kTriangle ? 0.1f : 0.0f) << "beyond the box";
        }
        if (away_x < inner.x_m && away_y < inner.y_m) {
          EXPECT_EQ(covered[i], 1.0f) << "in the inner box";
        }
        if (covered[i] <= 0.02f || covered[i] >= 0.98f) continue;
        // At a corner two ramps start.
        if (std::abs(by_x[i] - slope_x[i]) < 3.0f && std::abs(by_y[i] - slope_y[i]) < 3.0f &&
            std::abs(by_width[i] - slope_width[i]) < 0.02f)
          ++edges;
        else
          ++kinks;
      }
    }
    EXPECT_GT(edges, 200);
    EXPECT_LE(kinks, 3);
    EXPECT_NEAR(area, static_cast<double>(area_m2(place)), 0.1 * static_cast<double>(area_m2(place)));
  }
}

TEST(EdgeWidth, FollowsThePicturesWithinLimits) {
  EdgeWidth width;
  const float first = width.px();
  width.follow({});
  EXPECT_EQ(width.px(), first);
  // Least squares with the true width of 1.8 pixels.
  for (int n = 0; n < 60; ++n) width.follow({10.0f, 10.0f * std::log(1.8f / width.px())});
  EXPECT_NEAR(width.px(), 1.8f, 0.02f);
  // One picture of many hardly matters.
  width.follow({10.0f, 10.0f * std::log(3.0f / width.px())});
  EXPECT_NEAR(width.px(), 1.8f, 0.1f);
  for (int n = 0; n < 200; ++n) width.follow({10.0f, 20.0f});
  EXPECT_EQ(width.px(), 4.0f);
  for (int n = 0; n < 200; ++n) width.follow({10.0f, -20.0f});
  EXPECT_EQ(width.px(), 1.3f);
}

}  // namespace
}  // namespace touchline::testing
