// Noise, flicker and timing from frames whose content is known.
#include "tools/programs/devices/judge/still_picture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "tools/programs/devices/judge/frame_timing.h"

namespace touchline::devices {
namespace {

constexpr std::uint16_t kWidth = 64, kHeight = 128;

/// Pictures of a gray wall under a lamp; `lamp` gives its brightness (1: normal) by row and frame.
template <class Lamp>
StillReport measure(Lamp lamp, double noise, double level = 100.0) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> error(0.0, noise);
  StillMeasurement measurement;
  std::vector<std::uint8_t> bytes(std::size_t{kWidth} * kHeight * 3 / 2, 128);
  Frame frame;
  frame.format = PixelFormat::kNv12;
  frame.width_px = kWidth;
  frame.height_px = kHeight;
  const PictureLayout layout = picture_layout(frame.format, kWidth, kHeight);
  for (std::size_t i = 0; i < 2; ++i) frame.plane[i] = bytes.data() + layout.offset_bytes[i];
  frame.stride_bytes = layout.stride_bytes;
  for (int n = 0; n < 120; ++n) {
    for (std::size_t v = 0; v < kHeight; ++v) {
      for (std::size_t u = 0; u < kWidth; ++u) {
        const double value = level * lamp(static_cast<double>(v), n) + error(random);
        bytes[v * kWidth + u] = static_cast<std::uint8_t>(std::clamp(std::lround(value), 0L, 255L));
      }
    }
    measurement.add(frame);
  }
  return measurement.report();
}

TEST(StillPicture, NoiseIsThatOfAPixel) {
  for (const double noise : {0.5, 2.0, 8.0}) {
    const StillReport report = measure([](double, int) { return 1.0; }, noise);
    EXPECT_NEAR(report.noise, std::hypot(noise, std::sqrt(1.0 / 12.0)), 0.05 * noise + 0.02);
    EXPECT_NEAR(report.brightness, 100.0, 1.0);
    EXPECT_LT(report.flicker, 0.01);
  }
}

TEST(StillPicture, ASlowChangeOfTheLightIsNoNoise) {
  const StillReport report = measure([](double, int n) { return 1.0 + 0.001 * n; }, 1.0);
  EXPECT_NEAR(report.noise, 1.05, 0.1);
}

TEST(StillPicture, FlickerOfTheWholePictureAndInBands) {
  const double amplitude = 0.05, rms = amplitude / std::sqrt(2.0);
  const StillReport whole = measure([&](double, int n) { return 1.0 + amplitude * std::sin(2.1 * n); }, 1.0);
  EXPECT_NEAR(whole.flicker, rms, 0.1 * rms);
  EXPECT_FALSE(whole.has_bands);
  // Two periods in the height of the picture, which wander.
  const StillReport bands =
      measure([&](double v, int n) { return 1.0 + amplitude * std::sin(0.098 * v + 2.1 * n); }, 1.0);
  EXPECT_NEAR(bands.flicker, rms, 0.1 * rms);
  EXPECT_TRUE(bands.has_bands);
}

TEST(FrameTiming, SeparatesRateJitterAndLosses) {
  std::mt19937_64 random(2);
  std::normal_distribution<double> jitter(0.0, 0.0005);
  std::vector<FrameTime> times;
  for (std::uint32_t n = 0; n < 600; ++n) {
    if (n % 100 == 50) continue;
    const double stamp_s = 1.0 + n / 50.0 + jitter(random);
    times.push_back({Instant(from_seconds(stamp_s)), Instant(from_seconds(stamp_s + 0.012)), n});
  }
  const TimingReport report = analyze_timing(times);
  EXPECT_EQ(report.frames, 594u);
  EXPECT_EQ(report.lost, 6u);
  EXPECT_NEAR(report.lost_share(), 0.01, 1e-9);
  EXPECT_NEAR(report.period_s, 0.02, 1e-6);
  EXPECT_NEAR(report.jitter_s, 0.0005, 0.00005);
  EXPECT_NEAR(report.delivered_hz, 49.5, 0.1);
  EXPECT_NEAR(report.delay_s, 0.012, 1e-6);
  EXPECT_LT(report.delay_spread_s, 1e-6);
  EXPECT_TRUE(report.increasing);
  times[10].capture = times[9].capture;
  EXPECT_FALSE(analyze_timing(times).increasing);
}

}  // namespace
}  // namespace touchline::devices
