// The sketch for Arduino on a simulated ATmega328P: bytes of our encoder go into its serial port, and its motor pins
// and the bytes that it sends are read.
#include <gtest/gtest.h>

#include "tests/radio/touchline_packets.h"
#include "tests/robot/avr_board.h"
#include "tools/robot/touchline_robot.h"

namespace touchline {
namespace {

using testing::AvrBoard;
using testing::MotorPins;

constexpr RobotId kSketchId = 3;
constexpr TeamNumber kSketchTeam = 7;
constexpr MotorPins kStill{};

Packet sketch_packet(std::uint8_t sequence, WheelSpeeds wheels, TeamNumber team = kNoTeamNumber) {
  Commands commands;
  commands.stop = false;
  commands.robots.push_back({0, {}, {1.0f, -1.0f}});
  commands.robots.push_back({kSketchId, {}, wheels});
  Packet packet;
  EXPECT_TRUE(encode(commands, sequence, packet, team).ok());
  return packet;
}

Packet sketch_stop(std::uint8_t sequence, TeamNumber team = kNoTeamNumber) {
  Packet packet;
  EXPECT_TRUE(encode({}, sequence, packet, team).ok());
  return packet;
}

std::span<const std::byte> span_of(const Packet& packet) { return {packet.data(), packet.size()}; }

// The sketch's own constants: 1.5 m/s at 255, and the wheels turn from 30.
MotorPins pins_of(WheelSpeeds wheels) {
  const auto pwm = [](float speed_mps) {
    return static_cast<int>(
        touchline_robot::pwm_from_speed(static_cast<std::int16_t>(std::lround(speed_mps * 1000.0f)), 1500, 30));
  };
  return {pwm(wheels.left_mps), pwm(wheels.right_mps)};
}

TEST(ArduinoSketch, StandsStillAtTheStart) {
  AvrBoard board(TOUCHLINE_SKETCHES "/sketch.bin");
  EXPECT_EQ(board.motors(), kStill);
  board.run_us(20000);
  EXPECT_EQ(board.motors(), kStill);
}

TEST(ArduinoSketch, DrivesWithTheSpeedsOfItsOwnEntry) {
  AvrBoard board(TOUCHLINE_SKETCHES "/sketch.bin");
  std::uint8_t sequence = 250;
  for (const WheelSpeeds wheels : {WheelSpeeds{0.5f, -0.25f}, WheelSpeeds{-1.234f, 0.001f}, WheelSpeeds{0.0f, 1.5f},
                                   WheelSpeeds{-32.767f, 32.767f}, WheelSpeeds{0.0f, 0.0f}}) {
    board.send_all(span_of(sketch_packet(sequence++, wheels)));
    EXPECT_EQ(board.motors(), pins_of(wheels)) << wheels.left_mps << " " << wheels.right_mps;
  }
  EXPECT_EQ(pins_of({0.5f, -0.25f}), (MotorPins{105, -67})) << "30 + 225 / 3, 30 + 225 / 6";
}

TEST(ArduinoSketch, StopsAtAStopAndWithoutItsEntry) {
  AvrBoard board(TOUCHLINE_SKETCHES "/sketch.bin");
  board.send_all(span_of(sketch_packet(10, {0.5f, 0.5f})));
  EXPECT_NE(board.motors(), kStill);
  board.send_all(span_of(sketch_stop(9)));
  EXPECT_EQ(board.motors(), kStill) << "a stop is obeyed whatever its sequence number is";
  board.send_all(span_of(sketch_packet(11, {0.5f, 0.5f})));
  EXPECT_NE(board.motors(), kStill);
  board.send_all(span_of(sketch_packet(11, {1.0f, 0.5f})));
  EXPECT_EQ(board.motors(), pins_of({0.5f, 0.5f})) << "a repeated packet has no effect";
  Commands others;
  others.stop = false;
  others.robots.push_back({4, {}, {1.0f, 1.0f}});
  Packet packet;
  ASSERT_TRUE(encode(others, 12, packet).ok());
  board.send_all(span_of(packet));
  EXPECT_EQ(board.motors(), kStill);
}

TEST(ArduinoSketch, StopsAfter200MillisecondsWithoutAPacket) {
  AvrBoard board(TOUCHLINE_SKETCHES "/sketch.bin");
  board.send_all(span_of(sketch_packet(1, {0.5f, 0.5f})));  // ends 1.5 ms after the packet
  board.run_us(197000);
  EXPECT_EQ(board.motors(), pins_of({0.5f, 0.5f}));
  board.run_us(2000);
  EXPECT_EQ(board.motors(), kStill);
  board.send_all(span_of(sketch_packet(1, {0.25f, 0.5f})));
  EXPECT_EQ(board.motors(), pins_of({0.25f, 0.5f})) << "any sequence number is accepted after the time-out";
}

TEST(ArduinoSketch, IgnoresOtherTeams) {
  AvrBoard board(TOUCHLINE_SKETCHES "/sketch_team.bin");
  const WheelSpeeds theirs{1.0f, 1.0f}, ours{0.5f, 0.25f};
  board.send_all(span_of(sketch_packet(1, theirs)));
  board.send_all(span_of(sketch_packet(2, theirs, 8)));
  EXPECT_EQ(board.motors(), kStill);
  board.send_all(span_of(sketch_packet(3, ours, kSketchTeam)));
  EXPECT_EQ(board.motors(), pins_of(ours));
  board.send_all(span_of(sketch_stop(4)));
  board.send_all(span_of(sketch_stop(5, 8)));
  EXPECT_EQ(board.motors(), pins_of(ours));
  board.send_all(span_of(sketch_stop(6, kSketchTeam)));
  EXPECT_EQ(board.motors(), kStill);

  AvrBoard without_number(TOUCHLINE_SKETCHES "/sketch.bin");
  without_number.send_all(span_of(sketch_packet(1, theirs, kSketchTeam)));
  EXPECT_EQ(without_number.motors(), kStill);
}

// A motor that moves is seen because it drives for 200 ms.
TEST(ArduinoSketch, DamagedBytesMoveNoMotor) {
  AvrBoard board(TOUCHLINE_SKETCHES "/sketch.bin");
  const Packet packet = sketch_packet(1, {1.5f, -1.5f});
  for (std::size_t bit = 0; bit < 8 * packet.size(); ++bit) {
    Packet damaged = packet;
    damaged[bit / 8] ^= static_cast<std::byte>(1U << (bit % 8));
    board.send_all(span_of(damaged));
    ASSERT_EQ(board.motors(), kStill) << "bit " << bit;
    board.run_us(1000);  // with the time to react, a pause that ends an incomplete packet
  }
  for (std::size_t size = 0; size < packet.size(); ++size) {
    board.send_all({packet.data(), size});
    ASSERT_EQ(board.motors(), kStill) << size << " bytes";
    board.run_us(1000);  // with the time to react, a pause that ends an incomplete packet
  }
  std::mt19937 random(1);
  for (int i = 0; i < 20; ++i) {
    std::vector<std::byte> noise(100);
    for (std::byte& byte : noise) byte = static_cast<std::byte>(random() % 256);
    board.send_all(noise);
    ASSERT_EQ(board.motors(), kStill);
  }
  board.run_us(3000);
  board.send_all(span_of(packet));
  EXPECT_EQ(board.motors(), pins_of({1.5f, -1.5f})) << "the packet itself is obeyed";
}

TEST(ArduinoSketch, ObeysThePacketAfterAnIncompleteOne) {
  AvrBoard board(TOUCHLINE_SKETCHES "/sketch.bin");
  board.send({sketch_packet(1, {0.5f, 0.5f}).data(), 10});
  board.run_us(4000);
  board.send_all(span_of(sketch_packet(2, {0.25f, 0.5f})));
  EXPECT_EQ(board.motors(), pins_of({0.25f, 0.5f}));
}

// Packets of eleven robots without a gap, the most that the line can carry: no byte is lost.
TEST(ArduinoSketch, KeepsUpWithAFullLine) {
  AvrBoard board(TOUCHLINE_SKETCHES "/sketch.bin");
  Commands commands;
  commands.stop = false;
  for (RobotId id = 0; id < static_cast<RobotId>(kMaxRobotsPerTeam); ++id) commands.robots.push_back({id, {}, {}});
  for (int i = 0; i < 70; ++i) {
    commands.robots[kSketchId].wheels = {0.001f * static_cast<float>(i), 0.5f};
    Packet packet;
    ASSERT_TRUE(encode(commands, static_cast<std::uint8_t>(i), packet).ok());
    board.send(span_of(packet));
  }
  board.send_all({});
  EXPECT_EQ(board.motors(), pins_of({0.069f, 0.5f}));
  board.take_sent();
  // The time-out would reset the percentage, so packets go on until the next telemetry.
  std::vector<std::byte> sent;
  for (int i = 70; i < 200 && sent.size() < kTelemetryBytes; ++i) {
    Packet packet;
    ASSERT_TRUE(encode(commands, static_cast<std::uint8_t>(i), packet).ok());
    board.send_all(span_of(packet));
    for (const AvrBoard::SentByte& byte : board.take_sent()) sent.push_back(byte.value);
  }
  RobotTelemetry telemetry;
  ASSERT_TRUE(decode_telemetry(sent, telemetry).ok());
  EXPECT_EQ(telemetry.link_percent, 100);
}

TEST(ArduinoSketch, SendsTelemetryTwiceASecond) {
  AvrBoard board(TOUCHLINE_SKETCHES "/sketch.bin");
  board.set_a0(3750);
  board.run_us(1300000);
  const std::vector<AvrBoard::SentByte> sent = board.take_sent();
  ASSERT_EQ(sent.size() % kTelemetryBytes, 0U);
  ASSERT_GE(sent.size(), 2 * kTelemetryBytes);
  ASSERT_LE(sent.size(), 3 * kTelemetryBytes);
  for (std::size_t begin = 0; begin < sent.size(); begin += kTelemetryBytes) {
    std::array<std::byte, kTelemetryBytes> bytes{};
    for (std::size_t i = 0; i < kTelemetryBytes; ++i) bytes[i] = sent[begin + i].value;
    RobotTelemetry telemetry;
    ASSERT_TRUE(decode_telemetry(bytes, telemetry).ok());
    EXPECT_EQ(telemetry.id, kSketchId);
    EXPECT_EQ(telemetry.sequence, begin / kTelemetryBytes);
    EXPECT_NEAR(telemetry.battery_v, 7.5f, 0.02f) << "3.75 V at the divider, in steps of 10 mV";
    EXPECT_EQ(telemetry.link_percent, kLinkUnknown) << "nothing was received";
    const std::int64_t before_us = begin == 0 ? 0 : sent[begin - kTelemetryBytes].time_us;
    EXPECT_GE(sent[begin].time_us - before_us, 399000);
    EXPECT_LE(sent[begin].time_us - before_us, 601000);
  }
}

// The stand-in for the radio module passes payloads of 32 bytes through the serial port.
TEST(ArduinoSketch, UnderstandsPayloadsOfAnNrf24) {
  AvrBoard board(TOUCHLINE_SKETCHES "/sketch_nrf24.bin", 500000);
  Commands commands;
  commands.stop = false;
  for (RobotId id = 0; id < 11; ++id) commands.robots.push_back({id, {}, {0.1f * static_cast<float>(id), -0.5f}});
  Packet packet;
  ASSERT_TRUE(encode(commands, 1, packet).ok());
  const auto filled = [](const Packet& bytes) {
    std::vector<std::byte> payloads(bytes.begin(), bytes.end());
    payloads.resize((payloads.size() + 31) / 32 * 32);
    return payloads;
  };
  board.send_all(filled(packet));
  EXPECT_EQ(board.motors(), pins_of({0.3f, -0.5f})) << "two payloads";
  board.send_all(filled(sketch_packet(2, {0.5f, 0.25f})));
  EXPECT_EQ(board.motors(), pins_of({0.5f, 0.25f}));
  board.send_all(filled(sketch_stop(3)));
  EXPECT_EQ(board.motors(), kStill);

  board.run_us(620000);
  const std::vector<AvrBoard::SentByte> sent = board.take_sent();
  ASSERT_GE(sent.size(), 32U);
  std::array<std::byte, kTelemetryBytes> bytes{};
  for (std::size_t i = 0; i < kTelemetryBytes; ++i) bytes[i] = sent[i].value;
  RobotTelemetry telemetry;
  EXPECT_TRUE(decode_telemetry(bytes, telemetry).ok());
}

}  // namespace
}  // namespace touchline
