#include "hal/mock/robot_telemetry.h"

#include <gtest/gtest.h>

#include "hal/mock/radio_channel.h"
#include "hal/mock/world.h"
#include "tests/mock/noise_free_arena.h"

namespace touchline::hal::mock {
namespace {

using namespace std::chrono_literals;

struct Listener {
  explicit Listener(const ArenaParameters& parameters, std::uint64_t seed = 1) : robots(parameters, seed) {}
  void advance(double for_s, bool link_good = true) {
    const Instant end = now + from_seconds(for_s);
    for (int i = 0; now < end; ++i) {
      now += 1ms;
      if (i % 16 == 0) {
        for (int id = 0; id < 5; ++id) robots.on_packet(id, link_good);
      }
      robots.advance(now);
      std::array<std::byte, 64> bytes{};
      while (const std::size_t count = robots.read(bytes)) monitor.listen(std::span(bytes).first(count), now, reports);
    }
  }
  RobotTelemetrySource robots;
  RobotMonitor monitor;
  RobotReports reports;
  Instant now{1s};
};

ArenaParameters perfect_air() {
  ArenaParameters parameters;
  parameters.radio.loss = parameters.radio.corruption = 0.0;
  return parameters;
}

TEST(RobotTelemetry, EachOwnRobotSendsAtItsRate) {
  Listener air(perfect_air());
  air.advance(10.0);
  ASSERT_EQ(air.reports.robots.size(), 5U);
  for (const RobotReport& robot : air.reports.robots) {
    EXPECT_NEAR(robot.packets, 20.0, 1.0);
    EXPECT_EQ(robot.missed, 0U);
    EXPECT_EQ(robot.last.link_percent, 100);
    EXPECT_GT(robot.last.battery_v, 7.8f);
    EXPECT_LE(robot.last.battery_v, 8.2f);
  }
  EXPECT_EQ(air.reports.foreign_bytes, 0U);
}

TEST(RobotTelemetry, TellsTheRobotOfReportsWithoutIdsAndWhatItsWheelsDo) {
  PacketLayout layout;
  layout.one_each = true;
  for (const FieldValue value : {FieldValue::kLeft, FieldValue::kRight}) {
    PacketField speed;
    speed.value = value;
    speed.type = FieldType::kI8;
    speed.scale = 100.0;
    layout.fields.push_back(speed);
  }
  RobotTelemetrySource robots(perfect_air(), 1);
  robots.set_layout(layout);
  for (int id = 0; id < 5; ++id) robots.measure(id, {0.1f * static_cast<float>(id), -0.25f});
  for (Instant now{1s}; now < Instant{3s}; now += 1ms) robots.advance(now);
  std::array<std::size_t, 5> reports{};
  std::array<std::byte, 64> bytes{};
  int id = 0;
  while (const std::size_t count = robots.read(bytes, id)) {
    ASSERT_LT(id, 5);
    for (std::size_t i = 0; i < count; i += 2) {
      EXPECT_EQ(bytes[i], static_cast<std::byte>(10 * id)) << id;
      EXPECT_EQ(bytes[i + 1], std::byte{256 - 25});
      ++reports[static_cast<std::size_t>(id)];
    }
  }
  for (const std::size_t count : reports) EXPECT_NEAR(static_cast<double>(count), 4.0, 1.0);
}

TEST(RobotTelemetry, BatteriesFallWithTimeAndUnderLoad) {
  ArenaParameters parameters = perfect_air();
  parameters.radio.battery_drop_v_per_min = 0.6;
  Listener air(parameters);
  air.advance(1.0);
  const float fresh = air.reports.robots[2].last.battery_v;
  air.advance(60.0);
  EXPECT_NEAR(fresh - air.reports.robots[2].last.battery_v, 0.6, 0.02);
  const float resting = air.reports.robots[2].last.battery_v;
  air.robots.on_wheel_speeds(2, {-1.0f, 1.0f});
  air.advance(1.0);
  EXPECT_NEAR(resting - air.reports.robots[2].last.battery_v, 0.3, 0.03);
}

TEST(RobotTelemetry, LinkQualityFollowsReception) {
  Listener air(perfect_air());
  air.advance(3.0, true);
  EXPECT_EQ(air.reports.robots[0].last.link_percent, 100);
  air.advance(3.0, false);
  EXPECT_LE(air.reports.robots[0].last.link_percent, 1);
}

TEST(RobotTelemetry, IsLostCorruptedAndTruncated) {
  ArenaParameters parameters;
  parameters.radio.loss = 0.1;
  parameters.radio.corruption = 0.1;
  parameters.radio.telemetry_hz = 50.0;
  Listener air(parameters);
  air.advance(30.0);
  const double sent = 5 * 50 * 30.0;
  // Four standard deviations. A truncated packet can delay the next one, but must not lose it.
  const double good = 0.9 * 0.9;
  EXPECT_NEAR(static_cast<double>(air.reports.packets) / sent, good, 4.0 * std::sqrt(good * (1 - good) / sent) + 0.001);
  EXPECT_GT(air.reports.foreign_bytes, 3000U);
}

TEST(RobotTelemetry, RateZeroSendsNothingAndTheBufferIsLimited) {
  ArenaParameters parameters = perfect_air();
  parameters.radio.telemetry_hz = 0.0;
  Listener silent(parameters);
  silent.advance(2.0);
  EXPECT_EQ(silent.reports.packets, 0U);
  parameters.radio.telemetry_hz = 50.0;
  RobotTelemetrySource unheard(parameters, 1);
  for (int ms = 0; ms < 60000; ++ms) unheard.advance(Instant(1s) + ms * 1ms);
  std::array<std::byte, 8192> bytes{};
  EXPECT_EQ(unheard.read(bytes), 4096U) << "the size of the kernel's serial buffer";
  EXPECT_EQ(unheard.read(bytes), 0U);
}

// Telemetry must not change the game.
TEST(RobotTelemetry, UsesItsOwnRandomStream) {
  const auto losses = [](double telemetry_hz) {
    ArenaParameters parameters;
    parameters.radio.telemetry_hz = telemetry_hz;
    World world(parameters, 3);
    RadioChannel channel(parameters, 115200, 3);
    Instant now{1s};
    for (int i = 0; i < 3000; ++i) {
      now += 1ms;
      world.step();
      channel.deliver(now, world);
      const Packet packet = packet_of(std::array<Drive, 1>{{{0, 0.1, 0.1}}}, static_cast<std::uint8_t>(i / 16));
      if (i % 16 == 0) {
        EXPECT_TRUE(channel.send(bytes_of(packet), now).ok());
      }
    }
    return std::pair(channel.statistics().lost, world.hash());
  };
  EXPECT_EQ(losses(0.0), losses(50.0));
}

}  // namespace
}  // namespace touchline::hal::mock
