#include "hal/mock/sensor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "hal/mock/renderer.h"

namespace touchline::hal::mock {
namespace {

constexpr std::uint16_t kSensorWidth = 320, kSensorHeight = 240;

// A linear gamma curve, so that the noise of the picture is that of the sensor.
SensorParameters linear_sensor() {
  SensorParameters parameters;
  parameters.gamma = 1.0;
  return parameters;
}

struct PixelMoments {
  double mean = 0.0, variance = 0.0;
};

// Mean and variance of a uniform picture with this much light, 0 to 1, in 8-bit steps.
PixelMoments exposed(const SensorParameters& parameters, double light, std::uint64_t seed = 1) {
  const std::vector<std::uint16_t> linear(std::size_t{3} * kSensorWidth * kSensorHeight,
                                          static_cast<std::uint16_t>(std::lround(light * kLinearScale)));
  std::vector<std::uint8_t> out(picture_layout(PixelFormat::kRgb24, kSensorWidth, kSensorHeight).bytes);
  Sensor(parameters, PixelFormat::kRgb24, kSensorWidth, kSensorHeight, seed).expose(linear, out);
  double sum = 0.0, squares = 0.0;
  for (const std::uint8_t value : out) {
    sum += value;
    squares += static_cast<double>(value) * value;
  }
  const double mean = sum / static_cast<double>(out.size());
  return {mean, squares / static_cast<double>(out.size()) - mean * mean};
}

TEST(Brightness, ScalesTheLightAndItsNoise) {
  const std::vector<std::uint16_t> half(std::size_t{3} * kSensorWidth * kSensorHeight, kLinearScale / 2);
  std::vector<std::uint8_t> as_darker(half.size());
  Sensor sensor(linear_sensor(), PixelFormat::kRgb24, kSensorWidth, kSensorHeight, 1);
  sensor.set_brightness(0.5);
  sensor.expose(half, as_darker);
  double sum = 0.0;
  for (const std::uint8_t value : as_darker) sum += value;
  EXPECT_NEAR(sum / static_cast<double>(half.size()), exposed(linear_sensor(), 0.25).mean, 0.1);
  sensor.set_brightness(100.0);
  sensor.expose(half, as_darker);
  EXPECT_GE(*std::min_element(as_darker.begin(), as_darker.end()), 240) << "saturated";
}

// The variance is the number of electrons (shot noise) plus that of the read noise; rounding adds 1/12.
TEST(Noise, HasTheStatedVarianceAtEachLevel) {
  SensorParameters parameters = linear_sensor();
  for (const double full_well : {1000.0, 9000.0}) {
    for (const double read_noise : {0.0, 18.0, 60.0}) {
      parameters.full_well_electrons = full_well;
      parameters.read_noise_electrons = read_noise;
      const double electrons_per_step = full_well / 255.0;
      for (const double light : {0.3, 0.5, 0.7}) {
        const PixelMoments seen = exposed(parameters, light);
        const double electrons = light * full_well;
        const double expected =
            (electrons + read_noise * read_noise) / (electrons_per_step * electrons_per_step) + 1.0 / 12.0;
        // Four standard deviations of the estimate. Noise must not change the mean.
        const double exact = std::round(light * kLinearScale) / kLinearScale;
        EXPECT_NEAR(seen.mean, 255.0 * exact, 0.005 + 4.0 * std::sqrt(expected / (3.0 * kSensorWidth * kSensorHeight)));
        EXPECT_NEAR(seen.variance, expected, 0.03 * expected) << full_well << ' ' << read_noise << ' ' << light;
      }
    }
  }
}

TEST(Noise, IsWhiteFromPixelToPixelAndFrameToFrame) {
  const std::vector<std::uint16_t> linear(std::size_t{3} * kSensorWidth * kSensorHeight, kLinearScale / 2);
  std::vector<std::uint8_t> first(picture_layout(PixelFormat::kRgb24, kSensorWidth, kSensorHeight).bytes),
      second(first);
  Sensor sensor(linear_sensor(), PixelFormat::kRgb24, kSensorWidth, kSensorHeight, 1);
  sensor.expose(linear, first);
  sensor.expose(linear, second);
  const auto correlation = [&](const std::vector<std::uint8_t>& a, const std::vector<std::uint8_t>& b,
                               std::size_t shift) {
    const double mean = 127.5;
    double sum = 0.0, squares = 0.0;
    for (std::size_t i = 0; i + shift < a.size(); ++i) {
      sum += (a[i] - mean) * (b[i + shift] - mean);
      squares += (a[i] - mean) * (a[i] - mean);
    }
    return sum / squares;
  };
  // Five standard deviations of the estimate from 230,400 values.
  for (const std::size_t shift : {std::size_t{1}, std::size_t{3}, std::size_t{4}, std::size_t{3} * kSensorWidth}) {
    EXPECT_NEAR(correlation(first, first, shift), 0.0, 0.0105) << shift;
  }
  EXPECT_NEAR(correlation(first, second, 0), 0.0, 0.0105);
}

TEST(Noise, DependsOnTheSeed) {
  const std::vector<std::uint16_t> linear(std::size_t{3} * 32 * 32, kLinearScale / 2);
  const auto picture = [&](std::uint64_t seed) {
    std::vector<std::uint8_t> out(picture_layout(PixelFormat::kRgb24, 32, 32).bytes);
    Sensor(SensorParameters{}, PixelFormat::kRgb24, 32, 32, seed).expose(linear, out);
    return out;
  };
  EXPECT_EQ(picture(1), picture(1));
  EXPECT_NE(picture(1), picture(2));
}

TEST(Tone, FollowsTheGammaCurve) {
  SensorParameters parameters;
  parameters.read_noise_electrons = 0.0;
  parameters.full_well_electrons = 1e7;  // almost no noise: 0.03 % of full scale
  for (const double gamma : {1.0, 2.2, 3.0}) {
    parameters.gamma = gamma;
    for (const double light : {0.05, 0.2, 0.5, 0.9, 1.0}) {
      EXPECT_NEAR(exposed(parameters, light).mean, 255.0 * std::pow(light, 1.0 / gamma), 0.7) << gamma << ' ' << light;
    }
    EXPECT_EQ(exposed(parameters, 0.0).mean, 0.0);
  }
}

TEST(Tone, FullScaleIsWhiteAndNoiseIsClippedAtBlack) {
  SensorParameters parameters;
  parameters.read_noise_electrons = 0.0;
  EXPECT_GT(exposed(parameters, 1.0).mean, 253.0);
  parameters.gamma = 1.0;
  parameters.full_well_electrons = 9000.0;
  parameters.read_noise_electrons = 360.0;  // 10.2 steps
  // The mean of a normal distribution clipped at zero is sigma / sqrt(2 pi).
  EXPECT_NEAR(exposed(parameters, 0.0).mean, 10.2 / std::sqrt(2.0 * 3.14159265), 0.15);
}

// Without noise, each pixel has its own color exactly and the mean of its neighbors for the others.
TEST(Bayer, InterpolatesFromTheNearestPixelsOfEachColor) {
  constexpr std::size_t kSide = 8;
  SensorParameters parameters = linear_sensor();
  parameters.read_noise_electrons = 0.0;
  parameters.full_well_electrons = 1e9;
  // Where red, the green of red's rows, the green of blue's rows and blue are, by pattern.
  const std::array<std::pair<BayerPattern, std::array<std::size_t, 2>>, 4> patterns{{{BayerPattern::kRggb, {0, 0}},
                                                                                     {BayerPattern::kGrbg, {1, 0}},
                                                                                     {BayerPattern::kGbrg, {0, 1}},
                                                                                     {BayerPattern::kBggr, {1, 1}}}};
  std::vector<std::uint16_t> linear(3 * kSide * kSide);
  for (std::size_t i = 0; i < linear.size(); ++i) linear[i] = static_cast<std::uint16_t>(i * 7919 % 4000);
  for (const auto& [pattern, red] : patterns) {
    parameters.bayer = pattern;
    std::vector<std::uint8_t> out(linear.size());
    Sensor(parameters, PixelFormat::kRgb24, kSide, kSide, 1).expose(linear, out);
    for (std::size_t v = 1; v + 1 < kSide; ++v) {
      for (std::size_t u = 1; u + 1 < kSide; ++u) {
        for (std::size_t c = 0; c < 3; ++c) {
          double sum = 0.0, nearest = 9.0, count = 0.0;
          for (std::size_t y = v - 1; y <= v + 1; ++y) {
            for (std::size_t x = u - 1; x <= u + 1; ++x) {
              const std::size_t off_u = (x + red[0]) % 2, off_v = (y + red[1]) % 2;
              if (off_u + off_v != c) continue;
              const double du = static_cast<double>(x) - static_cast<double>(u);
              const double dv = static_cast<double>(y) - static_cast<double>(v), away = du * du + dv * dv;
              if (away > nearest) continue;
              if (away < nearest) sum = count = 0.0;
              nearest = away;
              sum += linear[3 * (kSide * y + x) + c];
              count += 1.0;
            }
          }
          EXPECT_NEAR(out[3 * (kSide * v + u) + c], 255.0 * sum / count / kLinearScale, 0.6)
              << u << ' ' << v << ' ' << c;
        }
      }
    }
  }
}

// A Gaussian has the stated standard deviation and keeps the sum of the light.
TEST(Blur, SpreadsAPoint) {
  constexpr std::size_t kSide = 33, kMiddle = 16;
  std::vector<std::uint16_t> point(3 * kSide * kSide);
  point[3 * (kSide * kMiddle + kMiddle) + 1] = kLinearScale;
  for (const double sigma : {0.7, 1.5}) {
    GaussianBlur blur(sigma, kSide, kSide);
    const auto seen = blur(point);
    double sum = 0.0, squares = 0.0;
    for (std::size_t i = 0; i < kSide * kSide; ++i) {
      EXPECT_EQ(seen[3 * i] + seen[3 * i + 2], 0);
      const double du = static_cast<double>(i % kSide) - kMiddle;
      sum += seen[3 * i + 1];
      squares += du * du * seen[3 * i + 1];
    }
    EXPECT_NEAR(sum, kLinearScale, 0.01 * kLinearScale);
    EXPECT_NEAR(std::sqrt(squares / sum), sigma, 0.02 * sigma);
  }
}

}  // namespace
}  // namespace touchline::hal::mock
