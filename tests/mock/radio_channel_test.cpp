#include "hal/mock/radio_channel.h"

#include <gtest/gtest.h>

#include "tests/mock/noise_free_arena.h"

namespace touchline::hal::mock {
namespace {

using namespace std::chrono_literals;
constexpr Instant kStart{1s};

// A radio channel with a world; time advances in steps of the world, as in the arena.
struct Air {
  explicit Air(const ArenaParameters& parameters, int baud = 115200, std::uint64_t seed = 1)
      : world(parameters, seed), channel(parameters, baud, seed) {}

  void advance(Duration duration) {
    const Instant end = now + duration;
    while (now + 1ms <= end) {
      now += 1ms;
      world.step();
      channel.deliver(now, world);
    }
  }
  Result<void> send(const Packet& packet) { return channel.send(bytes_of(packet), now); }
  Result<void> drive(double left_mps, double right_mps, std::uint8_t sequence, bool stop = false) {
    const std::array<Drive, 1> drives{{{0, left_mps, right_mps}}};
    return send(packet_of(drives, sequence, stop));
  }
  [[nodiscard]] double speed() {
    const double before = world.snapshot().robots[0].x_m;
    advance(1ms);
    return (world.snapshot().robots[0].x_m - before) / World::kStepS;
  }

  World world;
  RadioChannel channel;
  Instant now = kStart;
};

ArenaParameters instant_wheels() {
  ArenaParameters parameters = noise_free_arena();
  parameters.physics.wheel_lag_s = 0.0;
  parameters.physics.tire_friction = 3.0;
  return parameters;
}

TEST(Channel, PausesAfterEachPacket) {
  RadioChannel channel(instant_wheels(), 115200, 1, 10ms);
  const std::array<Drive, 1> drives{{{0, 0.1, 0.1}}};
  const Packet packet = packet_of(drives, 1, false);
  const auto line_time = from_seconds(10.0 / 115200) * static_cast<int>(packet.size());
  ASSERT_TRUE(channel.send(bytes_of(packet), kStart).ok());
  EXPECT_EQ(channel.drained(), kStart + line_time);
  EXPECT_GT(channel.queued_bytes(kStart + line_time + 9ms), 0U);
  EXPECT_EQ(channel.queued_bytes(kStart + line_time + 10ms), 0U);
  ASSERT_TRUE(channel.send(bytes_of(packet), kStart).ok());
  EXPECT_EQ(channel.drained(), kStart + 2 * line_time + 10ms);
}

TEST(Channel, PacketActsAfterTransmissionAndDelay) {
  ArenaParameters parameters = instant_wheels();
  parameters.radio.delay_s = 0.015;
  // 13 bytes of 10 bits: 1.13 ms at 115200 baud, 13.5 ms at 9600.
  for (const auto& [baud, line_s] : {std::pair{115200, 0.001128}, {9600, 0.013542}}) {
    Air air(parameters, baud);
    ASSERT_TRUE(air.drive(0.02, 0.02, 1).ok());
    EXPECT_NEAR(seconds(air.channel.drained() - kStart), line_s, 1e-6);
    while (air.channel.statistics().obeyed == 0 && air.now < kStart + 100ms) air.advance(1ms);
    // Takes effect on the first step after the arrival.
    const double arrived_s = seconds(air.now - kStart);
    EXPECT_GE(arrived_s, line_s + 0.015);
    EXPECT_LE(arrived_s, line_s + 0.0161);
    EXPECT_NEAR(air.speed(), 0.02, 1e-6);
  }
}

// Ours sends stop packets all the time, theirs drives. Returns the highest speed.
double speed_beside_another_sender(TeamNumber robots, TeamNumber ours, TeamNumber theirs) {
  Air air(instant_wheels());
  air.channel.set_layouts(touchline_layout(robots), touchline_telemetry_layout());
  double highest = 0.0;
  for (std::uint8_t i = 1; i <= 50; ++i) {
    const std::array<Drive, 1> drives{{{0, 0.02, 0.02}}};
    EXPECT_TRUE(air.send(packet_of(drives, static_cast<std::uint8_t>(100 + i), false, theirs)).ok());
    air.advance(20ms);
    highest = std::max(highest, air.speed());
    EXPECT_TRUE(air.send(packet_of(drives, i, true, ours)).ok());
    air.advance(20ms);
    highest = std::max(highest, air.speed());
  }
  return highest;
}

TEST(Channel, ATeamNumberKeepsAnotherSenderFromDrivingTheRobots) {
  EXPECT_NEAR(speed_beside_another_sender(kNoTeamNumber, kNoTeamNumber, kNoTeamNumber), 0.02, 1e-3)
      << "robots without a number obey both";
  EXPECT_LT(speed_beside_another_sender(7, 7, 8), 1e-6);
  EXPECT_LT(speed_beside_another_sender(7, 7, kNoTeamNumber), 1e-6);
  EXPECT_LT(speed_beside_another_sender(kNoTeamNumber, kNoTeamNumber, 8), 1e-6);
}

TEST(Channel, ASenderWithTheRobotsTeamNumberDrivesThem) {
  Air air(instant_wheels());
  air.channel.set_layouts(touchline_layout(7), touchline_telemetry_layout());
  const std::array<Drive, 1> drives{{{0, 0.02, 0.02}}};
  ASSERT_TRUE(air.send(packet_of(drives, 1, false, 7)).ok());
  air.advance(20ms);
  EXPECT_NEAR(air.speed(), 0.02, 1e-6);
  EXPECT_EQ(air.channel.statistics().foreign, 0U);
}

TEST(Channel, LineSendsPacketsOneByOne) {
  Air air(noise_free_arena(), 115200);
  ASSERT_TRUE(air.drive(0.1, 0.1, 1).ok());
  const Instant first = air.channel.drained();
  ASSERT_TRUE(air.drive(0.1, 0.1, 2).ok());
  EXPECT_NEAR(seconds(air.channel.drained() - first), 13 * 10.0 / 115200, 1e-6);
}

TEST(Channel, RefusesAPacketThatDoesNotFitIntoTheQueue) {
  ArenaParameters parameters = noise_free_arena();
  parameters.radio.queue_bytes = 128;
  Air air(parameters, 9600);
  std::uint8_t sequence = 0;
  while (air.drive(0.1, 0.1, ++sequence).ok()) ASSERT_LT(sequence, 20);
  EXPECT_EQ(sequence, 10) << "nine packets of 13 bytes fit into 128";
  EXPECT_EQ(air.drive(0.1, 0.1, sequence).code(), ErrorCode::kBusy);
  const Instant drained = air.channel.drained();
  EXPECT_EQ(air.channel.statistics().sent, 9U);
  air.advance(15ms);  // a packet has left: 13.5 ms
  EXPECT_EQ(air.channel.drained(), drained) << "a refused packet must not use the line";
  EXPECT_TRUE(air.drive(0.1, 0.1, sequence).ok());
  air.advance(1s);
  EXPECT_EQ(air.channel.statistics().obeyed, 10U);
}

TEST(Channel, RefusesAPacketIfTooManyAreInFlight) {
  ArenaParameters parameters = noise_free_arena();
  parameters.radio.delay_s = 1.0;
  Air air(parameters, 4000000);
  std::uint8_t sequence = 0;
  int taken = 0;
  while (air.drive(0.1, 0.1, ++sequence).ok()) {
    air.advance(1ms);
    ++taken;
    ASSERT_LT(taken, 1000);
  }
  EXPECT_EQ(taken, 256);
  const Instant drained = air.channel.drained();
  EXPECT_EQ(air.drive(0.1, 0.1, sequence).code(), ErrorCode::kBusy);
  EXPECT_EQ(air.channel.drained(), drained);
}

TEST(Channel, RefusesEmptyAndOversizedPackets) {
  Air air(noise_free_arena());
  EXPECT_EQ(air.channel.send({}, air.now).code(), ErrorCode::kOutOfRange);
  const std::array<std::byte, kMaxPacketBytes + 1> bytes{};
  EXPECT_EQ(air.channel.send(bytes, air.now).code(), ErrorCode::kOutOfRange);
  air.advance(100ms);
  EXPECT_EQ(air.channel.statistics().due, 0U);
}

TEST(Channel, DiscardsBytesThatAreNoPacket) {
  Air air(noise_free_arena());
  const std::array<std::byte, 20> bytes{};
  ASSERT_TRUE(air.channel.send(bytes, air.now).ok());
  air.advance(100ms);
  EXPECT_EQ(air.channel.statistics().corrupted, 1U);
  EXPECT_EQ(air.channel.statistics().obeyed, 0U);
}

// Bounds: four standard deviations of a binomial distribution with this number of trials.
TEST(Channel, LossesErrorsAndDelayMatchTheParameters) {
  ArenaParameters parameters = noise_free_arena();
  parameters.radio.loss = 0.05;
  parameters.radio.corruption = 0.1;
  parameters.radio.delay_s = 0.01;
  Air air(parameters);
  std::uint8_t sequence = 0;
  constexpr int kPackets = 20000;
  for (int i = 0; i < kPackets; ++i) {
    ASSERT_TRUE(air.drive(0.1, 0.1, ++sequence).ok());
    air.advance(20ms);
  }
  const ChannelStatistics& heard = air.channel.statistics();
  EXPECT_EQ(heard.due, static_cast<std::uint64_t>(kPackets));
  EXPECT_NEAR(static_cast<double>(heard.lost) / kPackets, 0.05, 4.0 * std::sqrt(0.05 * 0.95 / kPackets));
  const double heard_at_all = static_cast<double>(kPackets - heard.lost);
  EXPECT_NEAR(static_cast<double>(heard.corrupted) / heard_at_all, 0.1, 4.0 * std::sqrt(0.1 * 0.9 / kPackets));
  EXPECT_EQ(heard.lost + heard.corrupted + heard.ignored + heard.obeyed, heard.due);
  EXPECT_EQ(heard.ignored, 0U) << "without jitter no packet can overtake another";
}

TEST(Channel, JitterIsExponentialWithItsMean) {
  ArenaParameters parameters = noise_free_arena();
  parameters.radio.delay_s = 0.002;
  parameters.radio.jitter_s = 0.01;
  Air air(parameters, 4000000);
  double sum = 0.0, squares = 0.0, least = 1.0;
  constexpr int kPackets = 4000;
  for (int i = 0; i < kPackets; ++i) {
    const std::uint64_t due = air.channel.statistics().due;
    const Instant sent = air.now;
    ASSERT_TRUE(air.drive(0.1, 0.1, static_cast<std::uint8_t>(i)).ok());
    while (air.channel.statistics().due == due) air.advance(1ms);
    // Observed half a step late on average.
    const double took_s = seconds(air.now - sent) - 0.0005 - 13 * 10.0 / 4e6 - 0.002;
    sum += took_s;
    squares += took_s * took_s;
    least = std::min(least, took_s);
  }
  const double mean = sum / kPackets, deviation = std::sqrt(squares / kPackets - mean * mean);
  EXPECT_NEAR(mean, 0.01, 4.0 * 0.01 / std::sqrt(kPackets));
  EXPECT_NEAR(deviation, 0.01, 0.001);
  EXPECT_GE(least, -0.0006);
}

TEST(Channel, LossesOfRobotsAreIndependent) {
  ArenaParameters parameters;
  parameters.radio.loss = 0.5;
  parameters.radio.corruption = 0.0;
  Air air(parameters);
  const std::array<Drive, 5> drives{{{0, 0.1, 0.1}, {1, 0.1, 0.1}, {2, 0.1, 0.1}, {3, 0.1, 0.1}, {4, 0.1, 0.1}}};
  bool some_heard_and_some_not = false;
  for (std::uint8_t i = 0; i < 40; ++i) {
    const std::uint64_t lost = air.channel.statistics().lost;
    ASSERT_TRUE(air.send(packet_of(drives, i)).ok());
    air.advance(50ms);
    const std::uint64_t missed = air.channel.statistics().lost - lost;
    some_heard_and_some_not |= missed > 0 && missed < 5;
  }
  EXPECT_EQ(air.channel.statistics().due, 200U);
  EXPECT_TRUE(some_heard_and_some_not);
}

TEST(Robot, IgnoresOvertakenPackets) {
  Air air(instant_wheels());
  ASSERT_TRUE(air.drive(0.02, 0.02, 6).ok());
  air.advance(50ms);
  ASSERT_TRUE(air.drive(-0.02, -0.02, 5).ok());
  air.advance(50ms);
  EXPECT_EQ(air.channel.statistics().ignored, 1U);
  EXPECT_NEAR(air.speed(), 0.02, 1e-6);
}

TEST(Robot, LargeJitterMakesPacketsOvertakeEachOther) {
  ArenaParameters parameters = noise_free_arena();
  parameters.radio.jitter_s = 0.05;
  Air air(parameters);
  std::uint8_t sequence = 0;
  for (int i = 0; i < 500; ++i) {
    ASSERT_TRUE(air.drive(0.1, 0.1, ++sequence).ok());
    air.advance(16ms);
  }
  air.advance(1s);
  EXPECT_EQ(air.channel.statistics().due, 500U);
  EXPECT_GT(air.channel.statistics().ignored, 100U);
  EXPECT_EQ(air.channel.statistics().ignored + air.channel.statistics().obeyed, 500U);
}

TEST(Robot, ObeysAStopWithAnySequenceNumber) {
  Air air(instant_wheels());
  ASSERT_TRUE(air.drive(0.02, 0.02, 100).ok());
  air.advance(50ms);
  EXPECT_NEAR(air.speed(), 0.02, 1e-6);
  ASSERT_TRUE(air.drive(0.02, 0.02, 7, true).ok());
  air.advance(50ms);
  EXPECT_NEAR(air.speed(), 0.0, 1e-9);
  EXPECT_EQ(air.channel.statistics().timeouts, 0U);
}

// The firmware's stop packets contain zero speeds, but docs/radio.md requires robots to obey the flag alone.
TEST(Robot, StopFlagOverridesSpeeds) {
  Air air(instant_wheels());
  Packet packet = packet_of(std::array<Drive, 1>{{{0, 0.02, 0.02}}}, 1);
  packet[3] |= kPacketFlagStop;
  unsigned crc = 0xFFFF;  // CRC-16/CCITT-FALSE
  for (std::size_t i = 0; i + 2 < packet.size(); ++i) {
    crc ^= std::to_integer<unsigned>(packet[i]) << 8U;
    for (int bit = 0; bit < 8; ++bit) crc = ((crc << 1U) ^ ((crc & 0x8000U) != 0 ? 0x1021U : 0U)) & 0xFFFFU;
  }
  packet[packet.size() - 2] = static_cast<std::byte>(crc & 0xFFU);
  packet[packet.size() - 1] = static_cast<std::byte>(crc >> 8U);
  ASSERT_TRUE(air.send(packet).ok());
  air.advance(50ms);
  EXPECT_EQ(air.channel.statistics().obeyed, 1U);
  EXPECT_EQ(air.world.energy(), 0.0);
}

TEST(Robot, StopsIfAPacketDoesNotListIt) {
  Air air(instant_wheels());
  ASSERT_TRUE(air.drive(0.02, 0.02, 1).ok());
  air.advance(50ms);
  const std::array<Drive, 1> other{{{9, 0.02, 0.02}}};
  ASSERT_TRUE(air.send(packet_of(other, 2)).ok());
  air.advance(50ms);
  EXPECT_NEAR(air.speed(), 0.0, 1e-9);
}

TEST(Robot, StopsAfterTheTimeOutAndThenObeysAnySequenceNumber) {
  Air air(instant_wheels());
  ASSERT_TRUE(air.drive(0.02, 0.02, 200).ok());
  air.advance(17ms);  // line and delay are 16.1 ms
  EXPECT_EQ(air.channel.statistics().obeyed, 1U);
  air.advance(198ms);
  EXPECT_NEAR(air.speed(), 0.02, 1e-6) << "before the time-out";
  EXPECT_EQ(air.channel.statistics().timeouts, 0U);
  air.advance(3ms);
  EXPECT_NEAR(air.speed(), 0.0, 1e-9);
  EXPECT_EQ(air.channel.statistics().timeouts, 1U);
  air.advance(5s);
  EXPECT_EQ(air.channel.statistics().timeouts, 1U) << "one silence counts as one time-out";
  ASSERT_TRUE(air.drive(0.02, 0.02, 199).ok()) << "an older number is valid after a time-out";
  air.advance(20ms);
  EXPECT_NEAR(air.speed(), 0.02, 1e-6);
}

TEST(Robot, StandsStillAtTheStartWithoutATimeOut) {
  Air air(noise_free_arena());
  air.advance(1s);
  EXPECT_EQ(air.channel.statistics().timeouts, 0U);
  EXPECT_EQ(air.world.energy(), 0.0);
}

}  // namespace
}  // namespace touchline::hal::mock
