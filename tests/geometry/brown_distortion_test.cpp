#include "core/geometry/brown_distortion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/geometry/reference_camera.h"

namespace touchline::testing {
namespace {

struct Lens {
  double k1, k2, k3, p1, p2;
  [[nodiscard]] BrownDistortion model() const { return {k1, k2, k3, p1, p2}; }
};

// Lenses: barrel, pincushion and mustache distortion, a webcam's, and one whose slope falls and rises again.
constexpr std::array<Lens, 6> kLenses{{{0, 0, 0, 0, 0},
                                       {-0.3, 0, 0, 0, 0},
                                       {0.25, 0.1, 0, 0, 0},
                                       {-0.35, 0.15, -0.03, 0, 0},
                                       {-0.28, 0.09, 0, 1.5e-3, -8e-4},
                                       {-0.6, 0.17, 0, 0, 0}}};

Point2 literal(const Lens& lens, Point2 ideal) {
  FullCamera camera;
  camera.pinhole.position_m = {0, 0, 1};
  camera.lens.fx_px = camera.lens.fy_px = 1;
  camera.lens.k1 = static_cast<float>(lens.k1);
  camera.lens.k2 = static_cast<float>(lens.k2);
  camera.lens.k3 = static_cast<float>(lens.k3);
  camera.lens.p1 = static_cast<float>(lens.p1);
  camera.lens.p2 = static_cast<float>(lens.p2);
  return camera.pixel({ideal[0], -ideal[1], 0});
}

TEST(BrownDistortion, FollowsBrownsFormulaUpToItsLimit) {
  for (const Lens& lens : kLenses) {
    const BrownDistortion model = lens.model();
    const double limit = std::min(model.limit(), 2.0);
    for (int turn = 0; turn < 24; ++turn) {
      for (int i = 0; i <= 20; ++i) {
        const double r = 0.999 * limit * i / 20, phi = turn * 0.2618;
        const Point2 ideal{r * std::cos(phi), r * std::sin(phi)};
        // The coefficients of the reference are floats.
        EXPECT_LT(distance(model.distort(ideal), literal(lens, ideal)), 1e-6) << lens.k1 << ' ' << r << ' ' << phi;
      }
    }
  }
}

TEST(BrownDistortion, HandComputedValues) {
  // r^2 = 0.25: 1 - 0.3 / 4 + 0.1 / 16 = 0.93125.
  const BrownDistortion radial(-0.3, 0.1, 0, 0, 0);
  EXPECT_NEAR(radial.distort({0.3, 0.4})[0], 0.279375, 1e-12);
  EXPECT_NEAR(radial.distort({0.3, 0.4})[1], 0.3725, 1e-12);
  // 2 p1 x y + p2 (r^2 + 2 x^2) and p1 (r^2 + 2 y^2) + 2 p2 x y.
  const BrownDistortion tangential(0, 0, 0, 0.01, 0.02);
  EXPECT_NEAR(tangential.distort({0.3, 0.4})[0], 0.3 + 0.0024 + 0.0086, 1e-12);
  EXPECT_NEAR(tangential.distort({0.3, 0.4})[1], 0.4 + 0.0057 + 0.0048, 1e-12);
}

TEST(BrownDistortion, InverseIsExactWithinTheLimit) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> k1(-0.45, 0.45), k2(-0.2, 0.2), k3(-0.05, 0.05), p(-3e-3, 3e-3),
      turn(0, 6.283), part(0, 1);
  for (int i = 0; i < 400; ++i) {
    const BrownDistortion model(k1(random), k2(random), k3(random), p(random), p(random));
    const double reach = 0.98 * std::min(model.limit(), 2.0);
    for (int j = 0; j < 50; ++j) {
      const double r = reach * part(random), phi = turn(random);
      const Point2 ideal{r * std::cos(phi), r * std::sin(phi)};
      EXPECT_LT(distance(model.undistort(model.distort(ideal)), ideal), 1e-10) << i << ' ' << r << ' ' << phi;
    }
  }
}

TEST(BrownDistortion, LimitIsWhereTheSlopeHasFallenToATenth) {
  EXPECT_NEAR(BrownDistortion(-0.3, 0, 0, 0, 0).limit(), 1.0, 1e-9);  // 1 - 0.9 r^2 = 0.1
  // 1 - 1.8 s + 0.85 s^2 = 0.1 with s = r^2: the first root, although the slope rises again after the second.
  EXPECT_NEAR(BrownDistortion(-0.6, 0.17, 0, 0, 0).limit(), std::sqrt((1.8 - std::sqrt(0.18)) / 1.7), 1e-9);
  EXPECT_EQ(BrownDistortion(0.3, 0, 0, 0, 0).limit(), BrownDistortion::kMaxRadius);
  EXPECT_EQ(BrownDistortion().limit(), BrownDistortion::kMaxRadius);
}

TEST(BrownDistortion, RadiusIsStrictlyIncreasing) {
  std::mt19937 random(8);
  std::uniform_real_distribution<double> k1(-10, 10), k2(-100, 100), k3(-1000, 1000);
  for (int i = 0; i < 300; ++i) {
    // First the whole range of the venue file, then that of real lenses.
    const double part = i < 100 ? 1.0 : 0.04;
    const BrownDistortion model(part * k1(random), part * part * k2(random), part * part * part * k3(random), 0, 0);
    double before = 0;
    for (double r = 0.005; r < 30; r *= 1.05) {
      const double now = model.distort({r, 0})[0];
      ASSERT_GT(now, before) << "radius " << r << ", limit " << model.limit();
      ASSERT_NEAR(model.undistort({now, 0})[0], r, 1e-6 * r) << "limit " << model.limit();
      before = now;
    }
  }
}

TEST(BrownDistortion, ContinuesAlongItsTangent) {
  const BrownDistortion model(-0.3, 0, 0, 0, 0);
  const double at_limit = model.distort({1, 0})[0];
  EXPECT_NEAR(at_limit, 0.7, 1e-9);
  EXPECT_NEAR(model.distort({3, 0})[0], 0.7 + 2 * BrownDistortion::kMinSlope, 1e-9);
  EXPECT_NEAR(model.undistort({0.9, 0})[0], 3.0, 1e-7);
  // The model is continuous, with a continuous derivative.
  constexpr double kStep = 1e-6;
  const double below = (at_limit - model.distort({1 - kStep, 0})[0]) / kStep;
  const double above = (model.distort({1 + kStep, 0})[0] - at_limit) / kStep;
  EXPECT_NEAR(below, above, 1e-4);
}

TEST(BrownDistortion, TangentialPartStopsGrowingAtTheLimit) {
  const BrownDistortion with(-0.3, 0, 0, 2e-3, 1e-3), without(-0.3, 0, 0, 0, 0);
  const auto part = [&](double r) {
    return distance(with.distort({0.6 * r, 0.8 * r}), without.distort({0.6 * r, 0.8 * r}));
  };
  EXPECT_NEAR(part(0.5) * 4, part(1.0 - 1e-9), 1e-8);
  EXPECT_NEAR(part(1.0), part(50.0), 1e-8);
}

TEST(BrownDistortion, FiniteForAnyCoefficients) {
  for (const double k : {-1000.0, -10.0, -1e-9, 1e-9, 10.0, 1000.0}) {
    for (const double p : {-1.0, 0.0, 1.0}) {
      const std::array<BrownDistortion, 4> models{BrownDistortion{k, 0, 0, p, p}, BrownDistortion{0, k, 0, p, 0},
                                                  BrownDistortion{0, 0, k, 0, p}, BrownDistortion{k, -k, k, p, -p}};
      for (const BrownDistortion& model : models) {
        for (const double r : {0.0, 1e-12, 0.1, 1.0, 10.0, 1e6, 1e30}) {
          const Point2 there = model.distort({r, -r}), back = model.undistort({r, -r});
          EXPECT_TRUE(std::isfinite(there[0]) && std::isfinite(there[1])) << k << ' ' << p << ' ' << r;
          EXPECT_TRUE(std::isfinite(back[0]) && std::isfinite(back[1])) << k << ' ' << p << ' ' << r;
        }
      }
    }
  }
}

}  // namespace
}  // namespace touchline::testing
