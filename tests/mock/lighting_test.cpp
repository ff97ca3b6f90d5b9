#include "hal/mock/lighting.h"

#include <gtest/gtest.h>

#include <cmath>

namespace touchline::hal::mock {
namespace {

double mean_on_floor(const Lighting& lighting, const ArenaField& field) {
  constexpr int kGrid = 50;
  double sum = 0.0;
  for (int i = 0; i < kGrid * kGrid; ++i) {
    const double x = ((i % kGrid + 0.5) / kGrid - 0.5) * field.length_m;
    const double y = ((i / kGrid + 0.5) / kGrid - 0.5) * field.width_m;
    sum += static_cast<double>(lighting.irradiance(static_cast<float>(x), static_cast<float>(y), 0.0f));
  }
  return sum / (kGrid * kGrid);
}

TEST(Lighting, MeanIrradianceOfTheFieldIsOne) {
  const ArenaField field;
  LightParameters light;
  for (const double ambient : {0.0, 0.35, 1.0}) {
    light.ambient = ambient;
    EXPECT_NEAR(mean_on_floor(Lighting(light, field), field), 1.0, 0.01);
  }
  light.ambient = 0.2;
  light.lamp = {{2.0, 0.0, 1.0, 500.0}};
  EXPECT_NEAR(mean_on_floor(Lighting(light, field), field), 1.0, 0.01);
  light.lamp.clear();
  EXPECT_FLOAT_EQ(Lighting(light, field).irradiance(0.3f, 0.2f, 0.0f), 1.0f);
  light.lamp = {{0.0, 0.0, 2.0, 0.0}};
  EXPECT_FLOAT_EQ(Lighting(light, field).irradiance(0.3f, 0.2f, 0.0f), 1.0f) << "lamps without power must not count";
}

TEST(Lighting, FallsOffWithSquareAndCosine) {
  LightParameters light;
  light.ambient = 0.0;
  light.lamp = {{0.0, 0.0, 2.0, 1.0}};
  const Lighting lighting(light, {});
  const float below = lighting.irradiance(0.0f, 0.0f, 0.0f);
  for (const float x : {0.5f, 1.0f, 2.0f}) {
    const float square = x * x + 4.0f;
    EXPECT_NEAR(lighting.irradiance(x, 0.0f, 0.0f) / below, 4.0f / square * 2.0f / std::sqrt(square), 1e-5f);
  }
  EXPECT_NEAR(lighting.irradiance(0.0f, 0.0f, 1.0f) / below, 4.0f, 1e-4f) << "half the distance";
  EXPECT_EQ(lighting.irradiance(0.0f, 0.0f, 2.5f), 0.0f) << "above the lamp";
}

TEST(Lighting, PowersAreRelativeToEachOther) {
  LightParameters light;
  light.ambient = 0.0;
  light.lamp = {{-0.5, 0.0, 2.0, 3.0}, {0.5, 0.0, 2.0, 1.0}};
  const Lighting lighting(light, {});
  EXPECT_NEAR(lighting.beam(0, -0.5f, 0.3f, 0.0f).strength / lighting.beam(1, 0.5f, 0.3f, 0.0f).strength, 3.0f, 1e-4f);
  const Lighting::Beam beam = lighting.beam(0, 0.5f, 1.0f, 0.0f);
  EXPECT_NEAR(beam.towards[0], -1.0f / std::sqrt(6.0f), 1e-6f);
  EXPECT_NEAR(beam.towards[1], -1.0f / std::sqrt(6.0f), 1e-6f);
  EXPECT_NEAR(beam.towards[2], 2.0f / std::sqrt(6.0f), 1e-6f);
}

// IEC 61966-2-1: 188 is half the reflectance; 12 lies on the linear part.
TEST(Reflectance, FollowsTheSrgbCurve) {
  EXPECT_NEAR(reflectance({188, 188, 188})[0], 0.5029f, 1e-4f);
  EXPECT_NEAR(reflectance({12, 10, 0})[1], 10.0f / 255.0f / 12.92f, 1e-6f);
  EXPECT_EQ(reflectance({255, 0, 255}), (LinearRgb{1.0f, 0.0f, 1.0f}));
}

}  // namespace
}  // namespace touchline::hal::mock
