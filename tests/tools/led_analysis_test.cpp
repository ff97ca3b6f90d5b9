// The LED in the picture against the edges of its line.
#include "tools/programs/latency/led_analysis.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace touchline::latency {
namespace {

using namespace std::chrono_literals;

constexpr Duration kPeriod = 16667us, kExposure = 4ms;

// A camera whose stamps are wrong by `stamp_error`; each packet is sent 9 ms after the middle of the exposure.
struct Recording {
  std::vector<LedFrame> frames;
  std::vector<LedEdge> edges;
};

Recording record(Duration stamp_error, double gamma, double noise, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> periods(10.0, 11.0);
  std::normal_distribution<double> read_noise(0.0, noise);
  Recording recording;
  Instant edge = Instant(10s) + 50ms;
  for (int i = 0; i < 200; ++i, edge += from_seconds(periods(random) * seconds(kPeriod))) {
    recording.edges.push_back({edge, i % 2 == 0, 2us});
  }
  for (int i = 0; i < 2090; ++i) {
    const Instant middle = Instant(10s) + i * kPeriod;
    double lit_s = 0.0;
    for (std::size_t k = 0; k + 1 < recording.edges.size(); k += 2) {
      const Instant begin = std::max(recording.edges[k].time, middle - kExposure / 2);
      const Instant end = std::min(recording.edges[k + 1].time, middle + kExposure / 2);
      lit_s += std::max(0.0, seconds(end - begin));
    }
    const double share = lit_s / seconds(kExposure);
    recording.frames.push_back(
        {middle + stamp_error, middle + 9ms, 30.0 + 150.0 * std::pow(share, 1.0 / gamma) + read_noise(random)});
  }
  return recording;
}

TEST(LedAnalysis, FindsTheStampsErrorAndTheTimeToThePacket) {
  for (const Duration error : {Duration(0ms), Duration(3ms), Duration(-5ms)}) {
    const Recording recording = record(error, 1.0, 1.0, 1);
    const LedReport report = analyze_led(recording.frames, recording.edges, kPeriod);
    EXPECT_EQ(report.refusal, "");
    EXPECT_GE(report.edges, 195u);
    ASSERT_TRUE(report.stamp_error.has_value());
    EXPECT_NEAR(seconds(*report.stamp_error), seconds(error), 3e-4);
    EXPECT_LE(seconds(report.stamp_resolution), 3e-4);
    // The edge is 0 to one period before the middle of the first exposure that shows half of it.
    EXPECT_NEAR(seconds(report.light_to_packet.p50), 9e-3 + seconds(kPeriod) / 2, 1.5e-3);
    EXPECT_LE(seconds(report.light_to_packet.max), 9e-3 + seconds(kPeriod) + 3e-4);
    EXPECT_EQ(report.capture_to_packet.p50, 9ms - error);
    // Of all edges, 80 % of 4 / 16.7 are within an exposure and change its brightness by more than a tenth.
    EXPECT_NEAR(static_cast<double>(report.partial), 38.0, 16.0);
    EXPECT_NEAR(report.off_level, 30.0, 1.0);
    EXPECT_NEAR(report.on_level, 180.0, 1.0);
  }
}

TEST(LedAnalysis, ToneCurvesDoNotMatter) {
  const Recording recording = record(1ms, 2.2, 1.0, 2);
  const LedReport report = analyze_led(recording.frames, recording.edges, kPeriod);
  ASSERT_TRUE(report.stamp_error.has_value());
  EXPECT_NEAR(seconds(*report.stamp_error), 1e-3, 4e-4);
}

TEST(LedAnalysis, RefusesWhatItCannotSee) {
  Recording recording = record(0ms, 1.0, 1.0, 3);
  for (LedFrame& frame : recording.frames) frame.level = 40.0 + 0.01 * frame.level;
  EXPECT_EQ(analyze_led(recording.frames, recording.edges, kPeriod).refusal,
            "the LED is not visible there: brightness 42 when on, 40 when off");
  EXPECT_EQ(analyze_led(recording.frames, {}, kPeriod).refusal, "too few edges; measure longer");
  EXPECT_EQ(analyze_led({}, recording.edges, kPeriod).refusal, "too few edges; measure longer");
}

TEST(LedAnalysis, EdgesOfUncertainTimeDoNotCount) {
  Recording recording = record(0ms, 1.0, 1.0, 4);
  for (std::size_t i = 0; i < recording.edges.size(); i += 10) {
    recording.edges[i].uncertainty = 5ms;
    recording.edges[i].time += 4ms;
  }
  const LedReport report = analyze_led(recording.frames, recording.edges, kPeriod);
  EXPECT_EQ(report.uncertain, 20u);
  EXPECT_LE(seconds(report.light_to_packet.max), 9e-3 + seconds(kPeriod) + 3e-4);
}

TEST(LedAnalysis, ReadsThePlace) {
  LedPlace place;
  EXPECT_EQ(parse_led_place("600,30.5", place), "");
  EXPECT_EQ(place.v_px, 30.5);
  EXPECT_EQ(place.radius_px, 3.0);
  EXPECT_EQ(parse_led_place("600,30,8", place), "");
  EXPECT_EQ(place.radius_px, 8.0);
  for (const char* text : {"", "600", "600,", "600,x", "600,30,", "600,30,0", "600,30,5,", "-1,30", "600 30"}) {
    EXPECT_NE(parse_led_place(text, place), "") << text;
  }
}

}  // namespace
}  // namespace touchline::latency
