// Status light, strobe, start button, and telemetry of the robots.
#include <algorithm>

#include "tests/firmware/loop_fixture.h"
#include "tests/radio/touchline_packets.h"

namespace touchline::testing {
namespace {

using namespace std::chrono_literals;

constexpr double kReleaseTime = 0.1;

/// Returns the longest time without a change of the light in the interval [from_s, to_s).
double longest_rest(const std::vector<std::pair<double, bool>>& light, double from_s, double to_s) {
  double longest = 0.0, last = from_s;
  for (const auto& [at_s, on] : light) {
    if (at_s < from_s || at_s >= to_s) continue;
    longest = std::max(longest, at_s - last);
    last = at_s;
  }
  return std::max(longest, to_s - last);
}

std::size_t changes(const std::vector<std::pair<double, bool>>& light, double from_s, double to_s) {
  return static_cast<std::size_t>(
      std::count_if(light.begin(), light.end(), [&](const auto& c) { return c.first >= from_s && c.first < to_s; }));
}

TEST_F(LoopTest, LightBlinksSlowlyWithGoodFramesAndFastWithout) {
  camera.add({4.0, 8.0, ErrorCode::kTimeout});
  start();
  run_until(12.0);
  loop->close();
  EXPECT_EQ(changes(gpio.led, 0.4, 3.9), 7U);
  EXPECT_LE(longest_rest(gpio.led, 0.4, 3.9), 0.56);
  EXPECT_NEAR(static_cast<double>(changes(gpio.led, 4.3, 7.9)), 36.0, 2.0);
  EXPECT_LE(longest_rest(gpio.led, 4.3, 7.9), 0.16);
  EXPECT_EQ(changes(gpio.led, 8.4, 11.9), 7U);
  for (std::size_t i = 1; i < gpio.led.size(); ++i) {
    EXPECT_NE(gpio.led[i].second, gpio.led[i - 1].second) << "a superfluous call of the kernel";
  }
  EXPECT_FALSE(gpio.led.back().second) << "off after the end of the program";
}

TEST_F(LoopTest, StrobeIsHighDuringTheProcessingOfEachFrame) {
  camera.add({1.0, 1.2, ErrorCode::kTimeout});
  start();
  run_until(2.0);
  ASSERT_EQ(gpio.strobe.size(), 2 * loop->statistics().frames);
  for (std::size_t i = 0; i < gpio.strobe.size(); ++i) EXPECT_EQ(gpio.strobe[i].second, i % 2 == 0);
}

/// Reported faults of the GPIO chip.
std::vector<FaultReport> gpio_faults(const std::vector<Report>& reports) {
  std::vector<FaultReport> faults;
  for (const Report& report : reports) {
    if (report.kind == Report::Kind::kFault && report.fault.device == Device::kGpio) faults.push_back(report.fault);
  }
  return faults;
}

TEST_F(LoopTest, AFailingLightIsReportedOnceAndTheGameContinues) {
  start();
  run_until(1.0);
  gpio.outputs = ErrorCode::kIo;
  run_until(5.0);
  EXPECT_FALSE(all_stop(0.0, 5.0));
  EXPECT_EQ(gpio.opened, 1) << "the chip stays open for the emergency stop";
  const std::vector<FaultReport> faults = gpio_faults(reports());
  ASSERT_EQ(faults.size(), 1U);
  EXPECT_EQ(faults[0].action, FaultAction::kContinueWithout);
  EXPECT_EQ(changes(gpio.led, 1.001, 5.0) + changes(gpio.strobe, 1.001, 5.0), 1U)
      << "no further calls after the failure";
  // A lost emergency stop makes the loop reopen the chip; light and strobe then work again.
  gpio.outputs = {};
  gpio.add({5.0, 5.3, ErrorCode::kDisconnected});
  run_until(8.0);
  EXPECT_TRUE(all_stop(5.001, 5.3));
  EXPECT_FALSE(all_stop(6.0, 8.0));
  EXPECT_GE(changes(gpio.led, 6.0, 8.0), 3U);
  EXPECT_GE(changes(gpio.strobe, 6.0, 8.0), 190U);
}

TEST_F(LoopTest, ABoardWithoutAnEmergencyStopPlaysWithoutItsChip) {
  settings.emergency_stop = false;
  settings.faults.leave_after_s = 1.0;
  gpio.add({1.0, 3.9, ErrorCode::kDisconnected});
  start();
  run_until(8.0);
  EXPECT_FALSE(all_stop(0.0, 8.0));
  EXPECT_EQ(loop->statistics().reopened[2], 1U);
  EXPECT_GE(gpio.opened, 4);
  EXPECT_GE(changes(gpio.led, 5.5, 8.0), 4U) << "it blinks again";
  const std::vector<FaultReport> faults = gpio_faults(reports());
  ASSERT_EQ(faults.size(), 1U);
  EXPECT_EQ(faults[0].code, ErrorCode::kDisconnected);
  EXPECT_EQ(faults[0].action, FaultAction::kContinueWithout);
}

TEST_F(LoopTest, AStartButtonWorksAfterItsChipIsReopened) {
  settings.emergency_stop = false;
  settings.start_button = true;
  gpio.add({1.0, 2.2, ErrorCode::kIo});
  gpio.press(1.5);
  gpio.press(4.0);
  start();
  run_until(6.0);
  EXPECT_TRUE(all_stop(0.0, 2.2));
  EXPECT_FALSE(all_stop(4.04, 6.0));
  const auto is_reopening = [](const FaultReport& fault) { return fault.action == FaultAction::kReopen; };
  std::vector<FaultReport> faults = gpio_faults(reports());
  EXPECT_TRUE(std::any_of(faults.begin(), faults.end(), is_reopening))
      << "no game is running: robots wait for the button";
  ASSERT_FALSE(faults.empty());
  EXPECT_EQ(faults.back().code, ErrorCode::kOk);
  gpio.add({6.0, 6.5, ErrorCode::kIo});
  run_until(9.0);
  EXPECT_FALSE(all_stop(6.0, 9.0));
  EXPECT_GE(loop->statistics().reopened[2], 2U);
  faults = gpio_faults(reports());
  EXPECT_TRUE(std::none_of(faults.begin(), faults.end(), is_reopening)) << "now a game is running";
  EXPECT_TRUE(faults.empty() || faults.back().code != ErrorCode::kOk);
}

TEST_F(LoopTest, AFailingLightDoesNotDisturbTheStartButton) {
  settings.emergency_stop = false;
  settings.start_button = true;
  gpio.outputs = ErrorCode::kIo;
  gpio.press(4.0);
  start();
  run_until(6.0);
  EXPECT_FALSE(all_stop(4.04, 6.0));
  EXPECT_EQ(gpio.opened, 1);
  const std::vector<FaultReport> faults = gpio_faults(reports());
  ASSERT_EQ(faults.size(), 1U);
  EXPECT_EQ(faults[0].action, FaultAction::kContinueWithout);
}

TEST_F(LoopTest, ALostChipHaltsEvenIfTheStrobeFailsFirst) {
  start();
  run_until(1.0);
  gpio.add({1.0, 1.3, ErrorCode::kDisconnected});
  run_until(3.0);
  EXPECT_EQ(loop->statistics().reopened[2], 1U);
  EXPECT_TRUE(all_stop(1.03, 1.3));
  EXPECT_FALSE(all_stop(2.0, 3.0));
}

TEST_F(LoopTest, RobotsAreStoppedUntilTheStartButtonIsPressed) {
  settings.start_button = true;
  gpio.press(1.5);
  start();
  run_until(3.0);
  EXPECT_TRUE(all_stop(0.0, 1.5));
  EXPECT_FALSE(all_stop(1.54, 3.0));
  EXPECT_LE(changes(gpio.led, 0.1, 1.5), 0U) << "the light stays on while the loop waits for the start";
  EXPECT_TRUE(std::prev(std::find_if(gpio.led.begin(), gpio.led.end(), [](const auto& c) {
                return c.first >= 1.499;
              }))->second);
  std::vector<std::uint32_t> halts;
  for (const Report& report : reports()) {
    if (report.kind == Report::Kind::kHalt) halts.push_back(report.halt.halt);
  }
  EXPECT_EQ(halts.back(), kHaltNone);
  EXPECT_NE(std::find(halts.begin(), halts.end(), kHaltStart), halts.end());
}

TEST_F(LoopTest, StartButtonEndsAnEmergencyOnlyAfterTheRelease) {
  settings.faults.resume_after_emergency = false;
  gpio.pull(1.0, 2.0);
  gpio.press(1.5);
  gpio.press(3.0);
  gpio.pull(5.0, 6.0);
  gpio.press(6.05);  // the pull is within the release time, so it takes effect at the end of that time
  gpio.pull(8.0, 8.5);
  start();
  run_until(12.0);
  EXPECT_FALSE(all_stop(0.0, 1.0));
  EXPECT_TRUE(all_stop(1.001, 3.0)) << "pressed while it was pulled";
  EXPECT_FALSE(all_stop(3.04, 5.0));
  EXPECT_TRUE(all_stop(5.001, 6.0 + kReleaseTime - 0.03));
  EXPECT_FALSE(all_stop(6.0 + kReleaseTime + 0.04, 8.0));
  EXPECT_TRUE(all_stop(8.001, 12.0)) << "each emergency needs its own press";
}

TEST_F(LoopTest, WaitsNoLongerThanTheDebouncingOfALine) {
  camera.add({0.5, 1.5, ErrorCode::kTimeout});
  gpio.next_poll_in = 3ms;
  gpio.pull(1.001, 2.0);
  start();
  run_until(1.4);
  const auto sent = packets(1.001, 1.4);
  ASSERT_FALSE(sent.empty());
  // Without frames the loop reads the lines every 50 ms, and earlier if a line is being debounced.
  EXPECT_TRUE(sent.front().stop);
  EXPECT_LE(sent.front().at_s, 1.001 + 0.05);
  EXPECT_GE(gpio.reads, 100);
}

class TelemetryLoopTest : public LoopTest {
 protected:
  void say(int id, float battery_v, int sequence, int link = 97) {
    radio.add_received(encode_telemetry(
        {static_cast<RobotId>(id), static_cast<std::uint8_t>(sequence), battery_v, static_cast<std::int8_t>(link)}));
  }
};

TEST_F(TelemetryLoopTest, StatusShowsTheTelemetryAndItsAge) {
  start();
  run_until(0.5);
  say(3, 7.7f, 1);
  run_until(1.0);
  say(1, 7.9f, 1, kLinkUnknown);
  run_until(2.1);
  const auto all = reports();
  const auto last =
      std::find_if(all.rbegin(), all.rend(), [](const Report& r) { return r.kind == Report::Kind::kStatus; });
  ASSERT_NE(last, all.rend());
  const auto& words = last->status.robot_status;
  ASSERT_EQ(words.size(), 2U);
  EXPECT_EQ(words[0].id, 1);
  EXPECT_EQ(words[0].link_percent, kLinkUnknown);
  EXPECT_EQ(words[1].id, 3);
  EXPECT_NEAR(words[1].battery_v, 7.7f, 1e-3f);
  EXPECT_EQ(words[1].link_percent, 97);
  EXPECT_NEAR(words[1].age_s, 1.5, 0.06);
  EXPECT_EQ(loop->statistics().robots.robots.size(), 2U);
}

TEST_F(TelemetryLoopTest, ABatteryThatBecomesLowIsReportedOnce) {
  auto parameters = fake_camera_parameters();
  parameters.low_battery_v = 7.0f;
  start();
  ASSERT_TRUE(pipeline->configure(parameters).ok());
  int sequence = 0;
  for (double until_s = 0.1; until_s < 3.0; until_s += 0.1) {
    say(2, until_s < 2.0 ? 6.8f : 8.2f, ++sequence);
    run_until(until_s);
  }
  for (double until_s = 3.0; until_s < 4.0; until_s += 0.1) {
    say(2, 6.7f, ++sequence);
    run_until(until_s);
  }
  std::vector<BatteryReport> low;
  for (const Report& report : reports()) {
    if (report.kind == Report::Kind::kBattery) low.push_back(report.battery);
  }
  ASSERT_EQ(low.size(), 2U) << "once per battery";
  EXPECT_EQ(low[0].id, 2);
  EXPECT_NEAR(low[0].battery_v, 6.8f, 1e-3f);
  EXPECT_GT(low[1].elapsed_s, 3.0);
}

TEST_F(TelemetryLoopTest, TelemetryCanBeDisabled) {
  settings.telemetry = false;
  start();
  say(3, 7.7f, 1);
  run_until(0.5);
  EXPECT_EQ(loop->statistics().robots.robots.size(), 0U);
  EXPECT_EQ(radio.counters().received_bytes, 0U);
}

TEST_F(TelemetryLoopTest, GarbageFromTheRadioDoesNotDelayTheLoop) {
  start();
  std::vector<std::byte> garbage(100000, kTelemetryMagic0);
  radio.add_received(garbage);
  run_until(1.0);
  EXPECT_EQ(loop->statistics().frames, 50U);
  EXPECT_EQ(radio.counters().received_bytes, 512U * 50U) << "the limit per frame";
  EXPECT_GT(loop->statistics().robots.foreign_bytes, 25000U);
}

}  // namespace
}  // namespace touchline::testing
