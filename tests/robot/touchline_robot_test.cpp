// The robots' header byte by byte against the encoder and decoder of core/radio.
#include "tools/robot/touchline_robot.h"

#include <gtest/gtest.h>

#include <random>
#include <span>
#include <vector>

#include "tests/radio/noisy_line.h"
#include "tests/radio/touchline_packets.h"

namespace touchline {
namespace {

using touchline_robot::kPauseUs;
using touchline_robot::kTimeOutUs;
using touchline_robot::Robot;

// The two sides' constants.
static_assert(touchline_robot::kMaxRobots == kMaxRobotsPerTeam);
static_assert(touchline_robot::kMaxPacketBytes == packet_bytes(kMaxRobotsPerTeam, 255));
static_assert(touchline_robot::kTelemetryBytes == kTelemetryBytes);
static_assert(touchline_robot::kLinkNotMeasured == 255);

using Bytes = std::vector<std::uint8_t>;

Bytes robot_packet(const Commands& commands, std::uint8_t sequence, TeamNumber team = kNoTeamNumber) {
  Packet packet;
  EXPECT_TRUE(encode(commands, sequence, packet, team).ok());
  Bytes bytes;
  for (const std::byte byte : packet) bytes.push_back(std::to_integer<std::uint8_t>(byte));
  return bytes;
}

Commands one_command(RobotId id, float left_mps, float right_mps) {
  Commands commands;
  commands.stop = false;
  commands.robots.push_back({id, {}, {left_mps, right_mps}});
  return commands;
}

bool give(Robot& robot, const Bytes& bytes, std::uint32_t now_us) {
  return robot.receive(bytes.data(), static_cast<std::uint8_t>(bytes.size()), now_us);
}

void expect_wheels(const Robot& robot, int left_mmps, int right_mmps) {
  EXPECT_EQ(robot.wheels().left_mmps, left_mmps);
  EXPECT_EQ(robot.wheels().right_mmps, right_mmps);
}

// Random commands of zero to eleven robots with different ids.
class RandomCommands {
 public:
  Commands next() {
    Commands commands;
    commands.stop = pick(8) == 0;
    const std::size_t robots = pick(kMaxRobotsPerTeam + 1);
    while (commands.robots.size() < robots) {
      const auto id = static_cast<RobotId>(pick(pick(2) == 0 ? 128 : 16));
      const auto has_id = [id](const RobotCommand& robot) { return robot.id == id; };
      if (std::any_of(commands.robots.begin(), commands.robots.end(), has_id)) continue;
      commands.robots.push_back({id, {}, {speed_mps(), speed_mps()}});
    }
    return commands;
  }
  std::size_t pick(std::size_t n) { return static_cast<std::size_t>(random_() % n); }

 private:
  float speed_mps() { return 0.001f * static_cast<float>(static_cast<int>(pick(65535)) - 32767); }
  std::mt19937 random_{1};
};

TEST(Robot, ObeysEveryPacketOfTheEncoder) {
  RandomCommands random;
  for (int i = 0; i < 20000; ++i) {
    const Commands commands = random.next();
    auto id = static_cast<std::uint8_t>(random.pick(128));
    if (!commands.robots.empty() && random.pick(4) > 0) {
      id = static_cast<std::uint8_t>(commands.robots[random.pick(commands.robots.size())].id);
    }
    const auto team = static_cast<TeamNumber>(random.pick(2) == 0 ? 0 : random.pick(256));
    const auto sequence = static_cast<std::uint8_t>(random.pick(256));
    const Bytes bytes = robot_packet(commands, sequence, team);
    // What the decoder of core/radio reads for this robot.
    Commands decoded;
    std::uint8_t decoded_sequence = 0;
    ASSERT_TRUE(decode(std::as_bytes(std::span(bytes)), decoded, decoded_sequence, team).ok());
    WheelSpeeds expected;
    for (const RobotCommand& robot : decoded.robots) {
      if (robot.id == static_cast<RobotId>(id)) expected = robot.wheels;
    }
    Robot robot(id, team);
    for (std::size_t k = 0; k < bytes.size(); ++k) {
      ASSERT_EQ(robot.receive(bytes[k], 1000), k + 1 == bytes.size()) << "the last byte completes the packet";
    }
    expect_wheels(robot, static_cast<int>(std::lround(expected.left_mps * 1000.0f)),
                  static_cast<int>(std::lround(expected.right_mps * 1000.0f)));
  }
}

TEST(Robot, IgnoresEachSingleBitFlip) {
  RandomCommands random;
  for (int i = 0; i < 100; ++i) {
    const auto team = static_cast<TeamNumber>(i % 2 == 0 ? 0 : 1 + random.pick(255));
    const Bytes bytes = robot_packet(random.next(), static_cast<std::uint8_t>(i), team);
    for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
      Bytes damaged = bytes;
      damaged[bit / 8] = static_cast<std::uint8_t>(damaged[bit / 8] ^ (1U << (bit % 8)));
      // A robot of the packet's version and one of the other version.
      for (const TeamNumber own : {team, kNoTeamNumber, TeamNumber{1}}) {
        Robot robot(3, own);
        ASSERT_FALSE(robot.receive_datagram(damaged.data(), static_cast<std::uint8_t>(damaged.size()), 0))
            << "bit " << bit;
        ASSERT_FALSE(robot.has_link());
      }
    }
  }
}

TEST(Robot, IgnoresTruncatedPackets) {
  const Bytes bytes = robot_packet(one_command(3, 1.0f, 1.0f), 1);
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    Robot robot(3);
    EXPECT_FALSE(robot.receive_datagram(bytes.data(), static_cast<std::uint8_t>(size), 0));
    EXPECT_FALSE(give(robot, {bytes.begin() + 1 + static_cast<long>(size), bytes.end()}, 0));
    EXPECT_FALSE(robot.has_link());
  }
}

TEST(Robot, AMillionRandomBytesMoveNoRobot) {
  std::mt19937 random(2);
  Robot robot(3), of_team(3, 7);
  // Every third byte is one that a header contains.
  constexpr std::array<std::uint8_t, 6> kHeaderBytes{'T', 'L', 1, 2, 0, 7};
  for (std::uint32_t i = 0; i < 1000000; ++i) {
    const auto number = static_cast<std::uint32_t>(random());
    const auto byte =
        number % 3 == 0 ? kHeaderBytes[(number >> 8U) % kHeaderBytes.size()] : static_cast<std::uint8_t>(number >> 16U);
    ASSERT_FALSE(robot.receive(byte, i));
    ASSERT_FALSE(of_team.receive(byte, i));
  }
}

TEST(Robot, IgnoresOtherTeams) {
  for (const TeamNumber own : {kNoTeamNumber, TeamNumber{7}}) {
    for (const TeamNumber team : {kNoTeamNumber, TeamNumber{7}, TeamNumber{8}}) {
      Robot robot(3, own);
      EXPECT_EQ(give(robot, robot_packet(one_command(3, 1.0f, 1.0f), 1, team), 0), own == team);
      EXPECT_EQ(give(robot, robot_packet({}, 2, team), 0), own == team) << "a stop";
    }
  }
}

// The same decisions as core/radio's receiver, after each byte of a line that loses, changes and inserts bytes.
TEST(Robot, AgreesWithTheCoresReceiverOnANoisyLine) {
  RandomCommands commands;
  std::mt19937 random(4);
  testing::NoisyLine line(random);
  int whole = 0;
  for (int i = 0; i < 6000; ++i) {
    // Most sequence numbers are newer, some are repeated or out of order.
    const auto sequence = static_cast<std::uint8_t>(i - (random() % 10 == 0 ? static_cast<int>(random() % 4) : 0));
    const Bytes bytes = robot_packet(commands.next(), sequence, static_cast<TeamNumber>(random() % 3 * 7));
    whole += line.send(std::as_bytes(std::span(bytes))) ? 1 : 0;
  }
  for (const TeamNumber team : {kNoTeamNumber, TeamNumber{7}}) {
    Robot robot(3, team);
    CommandStream stream(team);
    SequenceFilter filter;
    WheelSpeeds wheels;
    int obeyed = 0;
    for (const std::byte byte : line.received()) {
      bool expected = false;
      stream.push(byte);
      Commands found;
      for (std::uint8_t sequence = 0; stream.next(found, sequence);) {
        if (!filter.obey(sequence, found.stop)) continue;
        expected = true;
        ++obeyed;
        wheels = {};
        for (const RobotCommand& command : found.robots) {
          if (command.id == 3) wheels = command.wheels;
        }
      }
      ASSERT_EQ(robot.receive(std::to_integer<std::uint8_t>(byte), 0), expected);
      ASSERT_EQ(robot.wheels().left_mmps, static_cast<int>(std::lround(wheels.left_mps * 1000.0f)));
      ASSERT_EQ(robot.wheels().right_mmps, static_cast<int>(std::lround(wheels.right_mps * 1000.0f)));
    }
    EXPECT_GT(obeyed, 300);
  }
  EXPECT_GT(whole, 1500);
}

TEST(Robot, AgreesWithTheCoreOnEachStepOfTheSequenceNumber) {
  for (const std::uint8_t last : {std::uint8_t{0}, std::uint8_t{200}}) {
    for (int step = 0; step < 256; ++step) {
      for (const bool stop : {false, true}) {
        const auto sequence = static_cast<std::uint8_t>(last + step);
        SequenceFilter filter;
        EXPECT_TRUE(filter.obey(last, false));
        Robot robot(3);
        EXPECT_TRUE(give(robot, robot_packet(one_command(3, 0.5f, 0.5f), last), 0));
        const Bytes next = robot_packet(stop ? Commands{} : one_command(3, 0.25f, 0.5f), sequence);
        ASSERT_EQ(give(robot, next, 0), filter.obey(sequence, stop)) << "step " << step;
      }
    }
  }
}

// Duplicate ids, ids above 127, team 0, too many robots: with a correct checksum, only the other checks find them.
TEST(Robot, AgreesWithTheCoreOnChangedBytesWithACorrectChecksum) {
  RandomCommands random;
  int refused = 0, accepted = 0;
  for (int i = 0; i < 20000; ++i) {
    const auto team = static_cast<TeamNumber>(i % 2 == 0 ? 0 : 7);
    Bytes bytes = robot_packet(random.next(), static_cast<std::uint8_t>(i), team);
    const std::size_t end = bytes.size() - 2;
    // Header and ids are hit more often than speeds.
    const std::size_t at = random.pick(2) == 0 ? random.pick(7) : random.pick(end);
    bytes[at] = static_cast<std::uint8_t>(random.pick(3) == 0 ? random.pick(12) : random.pick(256));
    const std::uint16_t crc = touchline_robot::crc_of(bytes.data(), static_cast<std::uint8_t>(end));
    bytes[end] = static_cast<std::uint8_t>(crc & 0xFFU);
    bytes[end + 1] = static_cast<std::uint8_t>(crc >> 8U);
    Commands decoded;
    std::uint8_t sequence = 0;
    const bool valid = decode(std::as_bytes(std::span(bytes)), decoded, sequence, team).ok();
    Robot robot(3, team);
    ASSERT_EQ(robot.receive_datagram(bytes.data(), static_cast<std::uint8_t>(bytes.size()), 0), valid) << "byte " << at;
    ++(valid ? accepted : refused);
  }
  EXPECT_GT(refused, 2000);
  EXPECT_GT(accepted, 2000);
}

TEST(Robot, RefusesPacketsThatNoEncoderSends) {
  const auto is_obeyed = [](Bytes bytes, TeamNumber team) {
    const std::uint16_t crc = touchline_robot::crc_of(bytes.data(), static_cast<std::uint8_t>(bytes.size()));
    bytes.push_back(static_cast<std::uint8_t>(crc & 0xFFU));
    bytes.push_back(static_cast<std::uint8_t>(crc >> 8U));
    Robot robot(3, team);
    return give(robot, bytes, 0);
  };
  EXPECT_TRUE(is_obeyed({'T', 'L', 1, 0, 9, 2, 3, 0, 1, 0, 1, 4, 0, 1, 0, 1}, 0)) << "the checksum is right";
  EXPECT_FALSE(is_obeyed({'T', 'L', 1, 0, 9, 2, 3, 0, 1, 0, 1, 3, 0, 1, 0, 1}, 0)) << "an id twice";
  EXPECT_FALSE(is_obeyed({'T', 'L', 1, 0, 9, 2, 3, 0, 1, 0, 1, 128, 0, 1, 0, 1}, 0)) << "an id above 127";
  EXPECT_FALSE(is_obeyed({'T', 'L', 2, 0, 9, 0, 1, 3, 0, 1, 0, 1}, 0)) << "team 0";
  EXPECT_FALSE(is_obeyed({'T', 'L', 3, 0, 9, 1, 3, 0, 1, 0, 1}, 0)) << "an unknown version";
}

TEST(Robot, StopsAfterTheTimeOut) {
  // The clock wraps during the test.
  constexpr std::uint32_t kStart = 0xFFFFFFFFU - 100000;
  Robot robot(3);
  EXPECT_FALSE(robot.has_link());
  EXPECT_TRUE(give(robot, robot_packet(one_command(3, 0.5f, -0.5f), 9), kStart));
  robot.update(kStart + kTimeOutUs - 1);
  expect_wheels(robot, 500, -500);
  EXPECT_FALSE(give(robot, robot_packet(one_command(3, 1.0f, 1.0f), 9), kStart + kTimeOutUs - 1))
      << "a repeated packet does not postpone the time-out";
  robot.update(kStart + kTimeOutUs);
  expect_wheels(robot, 0, 0);
  EXPECT_FALSE(robot.has_link());
  EXPECT_TRUE(give(robot, robot_packet(one_command(3, 1.0f, 1.0f), 8), kStart + 2 * kTimeOutUs))
      << "any sequence number";
}

TEST(Robot, AcceptsAnySequenceNumberAfterAPauseDuringWhichUpdateWasNotCalled) {
  Robot robot(3);
  EXPECT_TRUE(give(robot, robot_packet(one_command(3, 0.5f, 0.5f), 9), 0));
  EXPECT_TRUE(give(robot, robot_packet(one_command(4, 0.5f, 0.5f), 9), kTimeOutUs));
  expect_wheels(robot, 0, 0);
}

TEST(Robot, AStopIsObeyedWithAnySequenceNumber) {
  Robot robot(3);
  EXPECT_TRUE(give(robot, robot_packet(one_command(3, 0.5f, 0.5f), 10), 0));
  EXPECT_TRUE(give(robot, robot_packet({}, 9), 0));
  expect_wheels(robot, 0, 0);
  EXPECT_FALSE(give(robot, robot_packet(one_command(3, 0.5f, 0.5f), 10), 0)) << "an old stop makes nothing new";
  EXPECT_TRUE(give(robot, robot_packet(one_command(3, 0.5f, 0.5f), 11), 0));
  expect_wheels(robot, 500, 500);
}

TEST(Robot, APauseEndsAnIncompletePacket) {
  const Bytes first = robot_packet(one_command(3, 0.5f, 0.5f), 1),
              second = robot_packet(one_command(3, 0.25f, 0.5f), 2);
  const Bytes begin(first.begin(), first.begin() + 8), end(first.begin() + 8, first.end());
  // A short pause, or a long round of the main loop after which the rest is read before update() is called.
  Robot robot(3);
  give(robot, begin, 0);
  robot.update(kPauseUs);
  EXPECT_TRUE(give(robot, end, kPauseUs));
  give(robot, {second.begin(), second.begin() + 8}, 4000);
  EXPECT_TRUE(give(robot, {second.begin() + 8, second.end()}, 9000));
  // A long pause.
  Robot other(3);
  give(other, begin, 0);
  other.update(kPauseUs + 1);
  EXPECT_FALSE(give(other, end, kPauseUs + 1));
  EXPECT_TRUE(give(other, second, kPauseUs + 2));
}

TEST(Robot, MeasuresTheLink) {
  Robot robot(3);
  std::uint32_t now_us = 0;
  EXPECT_EQ(robot.link_percent(), touchline_robot::kLinkNotMeasured);
  const auto send_every = [&](int step, int packets) {
    static std::uint8_t sequence = 0;
    for (int i = 0; i < packets; ++i) {
      sequence = static_cast<std::uint8_t>(sequence + step);
      EXPECT_TRUE(give(robot, robot_packet({}, sequence), now_us += 16000));
      give(robot, robot_packet({}, sequence), now_us);  // a repeated one does not count
    }
  };
  send_every(1, 130);
  EXPECT_EQ(robot.link_percent(), 100);
  send_every(2, 70);
  EXPECT_EQ(robot.link_percent(), 50);
  send_every(4, 70);
  EXPECT_EQ(robot.link_percent(), 25);
  robot.update(now_us + kTimeOutUs);
  EXPECT_EQ(robot.link_percent(), touchline_robot::kLinkNotMeasured);
}

TEST(RobotTelemetry, HasTheBytesOfTheCoresEncoder) {
  std::mt19937 random(5);
  for (int i = 0; i < 2000; ++i) {
    RobotTelemetry expected;
    expected.id = static_cast<RobotId>(random() % 128);
    touchline_robot::Telemetry telemetry(static_cast<std::uint8_t>(expected.id));
    for (int k = 0; k < i % 5; ++k) {
      std::uint8_t unused[kTelemetryBytes];
      telemetry.write(0, 0, unused);
    }
    const auto battery_mv = static_cast<std::uint16_t>(random() % 65536);
    const auto link = static_cast<int>(random() % 102) - 1;
    std::uint8_t bytes[kTelemetryBytes];
    telemetry.write(battery_mv, link < 0 ? touchline_robot::kLinkNotMeasured : static_cast<std::uint8_t>(link), bytes);
    RobotTelemetry decoded;
    ASSERT_TRUE(decode_telemetry(std::as_bytes(std::span(bytes)), decoded).ok());
    EXPECT_EQ(decoded.id, expected.id);
    EXPECT_EQ(decoded.sequence, i % 5);
    EXPECT_EQ(decoded.link_percent, link);
    EXPECT_NEAR(decoded.battery_v, 0.001f * battery_mv, 1e-5f);
    const Packet encoded = encode_telemetry(decoded);
    EXPECT_TRUE(std::equal(encoded.begin(), encoded.end(), std::as_bytes(std::span(bytes)).begin()));
  }
}

TEST(RobotTelemetry, IsDueAtDifferentTimesForEachRobot) {
  // All robots start at the same moment, and a packet takes 1 ms: at two per second, chance puts two of eleven robots
  // into the same millisecond about once in five rounds.
  std::vector<int> sent(20000);
  for (std::uint8_t id = 0; id < 11; ++id) {
    touchline_robot::Telemetry telemetry(id);
    std::uint32_t last_ms = 0, packets = 0;
    for (std::uint32_t ms = 0; ms < sent.size(); ++ms) {
      if (!telemetry.is_due(ms * 1000)) continue;
      if (packets > 0) {
        EXPECT_GE(ms - last_ms, 400U);
        EXPECT_LE(ms - last_ms, 598U);
      }
      last_ms = ms;
      ++packets;
      ++sent[ms];
    }
    EXPECT_GE(packets, 36U);
    EXPECT_LE(packets, 46U);
  }
  int collisions = 0;
  for (const int packets : sent) collisions += packets > 1 ? packets : 0;
  EXPECT_LT(collisions, 30) << "of 440 packets";
}

}  // namespace
}  // namespace touchline
