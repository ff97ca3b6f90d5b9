// touchline-devices --judge before the arena's camera, whose properties are known.
#include "tools/programs/devices/judge/judge.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "hal/mock/arena.h"
#include "hal/mock/mock_devices.h"
#include "tools/programs/devices/judge/arena_hand.h"
#include "tools/programs/devices/judge/judge_text.h"

namespace touchline::testing {
namespace {

using devices::judge;
using devices::JudgeReport;

class CameraJudgeTest : public ::testing::Test {
 protected:
  CameraJudgeTest() {
    settings_.format = hal::CameraFormat::kYuyv;
    set_size(96, 72);
    devices::ArenaHand::put_lid(arena_);
    options_.still_s = 2.0;
    options_.motion_s = 0.0;
  }

  void set_size(std::uint16_t width_px, std::uint16_t height_px) {
    settings_.width_px = width_px;
    settings_.height_px = height_px;
    arena_.camera.focal_px = 560.0 / 640.0 * width_px;
    arena_.camera.center_u_px = 0.5 * width_px;
    arena_.camera.center_v_px = 0.5 * height_px;
  }

  Result<JudgeReport> run(std::uint64_t seed = 1) {
    hal::mock::Arena arena(arena_, settings_, {}, seed);
    hal::mock::ArenaClock clock(arena);
    hal::mock::MockCamera camera(arena, clock);
    hal::mock::MockRadio radio(arena, clock);
    EXPECT_TRUE(radio.open().ok());
    devices::ArenaHand hand(radio, clock, arena_.field);
    return judge(camera, clock, settings_, options_, {}, [&] { hand.move(); });
  }

  hal::mock::ArenaParameters arena_;
  hal::CameraSettings settings_;
  devices::JudgeOptions options_;
};

TEST_F(CameraJudgeTest, MeasuresAKnownReadoutTime) {
  options_.motion_s = 20.0;
  set_size(320, 240);
  for (const double readout_s : {0.0, 0.005, 0.012}) {
    arena_.sensor.readout_s = readout_s;
    const Result<JudgeReport> report = run();
    ASSERT_TRUE(report.ok()) << report.text();
    const devices::ShutterReport& shutter = report.value().shutter;
    ASSERT_TRUE(shutter.measured);
    EXPECT_NEAR(shutter.readout_s, readout_s, 0.001);
    EXPECT_LT(std::abs(shutter.readout_s - readout_s), 2.0 * shutter.sigma_s) << "the stated uncertainty is honest";
    EXPECT_LT(2.0 * shutter.sigma_s, 0.0015);
    const std::string verdict = devices::verdict(report.value());
    EXPECT_EQ(verdict.find("good for Touchline") != std::string::npos, readout_s < 0.006) << verdict;
  }
}

TEST_F(CameraJudgeTest, NothingMovesAndTheShutterStaysUnknown) {
  options_.motion_s = 3.0;
  hal::mock::Arena arena(arena_, settings_, {}, 1);
  hal::mock::ArenaClock clock(arena);
  hal::mock::MockCamera camera(arena, clock);
  const Result<JudgeReport> report = judge(camera, clock, settings_, options_, {});
  ASSERT_TRUE(report.ok()) << report.text();
  EXPECT_FALSE(report.value().shutter.measured);
  EXPECT_NE(devices::verdict(report.value()).find("its shutter was not measured"), std::string::npos);
}

TEST_F(CameraJudgeTest, RateStampsAndExposureAreThoseOfTheArena) {
  const Result<JudgeReport> report = run();
  ASSERT_TRUE(report.ok()) << report.text();
  const devices::TimingReport& timing = report.value().timing;
  EXPECT_NEAR(timing.delivered_hz, 60.0, 0.6);
  EXPECT_NEAR(timing.period_s, 1.0 / 60.0, 1e-4);
  EXPECT_EQ(timing.lost, 0u);
  EXPECT_LT(timing.jitter_s, 0.0005) << "the arena exposes on steps of a millisecond";
  EXPECT_NEAR(timing.delay_s, 0.5 * arena_.sensor.exposure_s + arena_.sensor.transfer_s, 0.002);
  ASSERT_EQ(report.value().exposures.size(), 5u);
  for (std::size_t i = 1; i < 5; ++i) {
    EXPECT_GT(report.value().exposures[i].brightness, report.value().exposures[i - 1].brightness);
  }
  EXPECT_NEAR(report.value().exposures[3].brightness, report.value().still.brightness, 2.0) << "5 ms is the setting";
}

TEST_F(CameraJudgeTest, LostFramesAreCounted) {
  arena_.fault.push_back({hal::mock::FaultKind::kCameraStall, 1.5, 0.5});
  const Result<JudgeReport> report = run();
  ASSERT_TRUE(report.ok()) << report.text();
  EXPECT_NEAR(static_cast<double>(report.value().timing.lost), 30.0, 2.0);
  EXPECT_NE(devices::verdict(report.value()).find("not usable, because"), std::string::npos);
}

TEST_F(CameraJudgeTest, NoiseIsThatOfTheSensor) {
  settings_.format = hal::CameraFormat::kRgb24;
  arena_.sensor.gamma = 1.0;
  arena_.light.exposure = 6.0;  // the floor is not dark
  for (const double read_noise : {50.0, 200.0}) {
    arena_.sensor.read_noise_electrons = read_noise;
    const Result<JudgeReport> report = run();
    ASSERT_TRUE(report.ok()) << report.text();
    const devices::StillReport& still = report.value().still;
    const double well = arena_.sensor.full_well_electrons;
    const double electrons = std::sqrt(read_noise * read_noise + still.brightness / 255.0 * well);
    const double expected = std::hypot(255.0 * electrons / well, std::sqrt(1.0 / 12.0));  // rounded to whole levels
    EXPECT_NEAR(still.noise, expected, 0.1 * expected);
    EXPECT_LT(still.flicker, 0.01);
  }
}

TEST_F(CameraJudgeTest, ACameraThatDisappearsEndsTheMeasurementWithItsMessage) {
  arena_.fault.push_back({hal::mock::FaultKind::kCameraLost, 2.0, 100.0});
  const Result<JudgeReport> report = run();
  ASSERT_FALSE(report.ok());
  EXPECT_EQ(report.code(), ErrorCode::kDisconnected);
  EXPECT_NE(report.text().find("mock camera: unplugged"), std::string::npos) << report.text();
}

}  // namespace
}  // namespace touchline::testing
