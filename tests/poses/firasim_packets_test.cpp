// FIRASim's packets against protobuf's own library, with the simulator's definitions.
#include "hal/poses/firasim_packets.h"

#include <gtest/gtest.h>
#include <tests/network/firasim.pb.h>

#include <array>
#include <limits>
#include <numbers>
#include <string>

namespace touchline::hal {
namespace {

namespace pb = fira_message;

std::span<const std::byte> bytes_of(const std::string& text) { return std::as_bytes(std::span(text)); }

template <class Packet>
std::string encoded(const Packet& packet) {
  std::array<std::byte, 8192> memory{};
  const std::size_t size = encode_firasim(packet, memory);
  return {reinterpret_cast<const char*>(memory.data()), size};
}

TEST(FirasimPackets, AnEnvironmentIsReadByProtobuf) {
  FirasimEnvironment environment;
  environment.step = 812;
  environment.field = {1.5, 1.3, 0.4, 0.1};
  environment.ball = {0.25, -0.5, 1.5, -0.125};
  environment.robots[0].push_back({2, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6});
  environment.robots[0].push_back({0, -0.1, 0.0, 0.0, 0.0, 0.0, 0.0});
  environment.robots[1].push_back({1, 0.7, -0.6, 3.0, 0.0, 0.0, -1.0});
  environment.goals = {3, 1};
  pb::Environment message;
  ASSERT_TRUE(message.ParseFromString(encoded(environment)));
  EXPECT_EQ(message.step(), 812u);
  EXPECT_EQ(message.field().length(), 1.5);
  EXPECT_EQ(message.field().goal_depth(), 0.1);
  EXPECT_EQ(message.frame().ball().vx(), 1.5);
  ASSERT_EQ(message.frame().robots_blue_size(), 2);
  EXPECT_EQ(message.frame().robots_blue(0).robot_id(), 0u) << "sorted by id";
  EXPECT_EQ(message.frame().robots_blue(1).vorientation(), 0.6);
  ASSERT_EQ(message.frame().robots_yellow_size(), 1);
  EXPECT_EQ(message.frame().robots_yellow(0).orientation(), 3.0);
  EXPECT_EQ(message.goals_blue(), 3u);
  EXPECT_EQ(message.goals_yellow(), 1u);
}

TEST(FirasimPackets, APacketWithPlacementsIsRead) {
  pb::Packet packet;
  pb::Command& command = *packet.mutable_cmd()->add_robot_commands();
  command.set_id(2);
  command.set_yellowteam(true);
  command.set_wheel_left(12.5);
  packet.mutable_replace()->mutable_ball()->set_x(0.5);
  packet.mutable_replace()->mutable_ball()->set_vy(-1.5);
  pb::RobotReplacement& robot = *packet.mutable_replace()->add_robots();
  robot.mutable_position()->set_robot_id(1);
  robot.mutable_position()->set_y(0.25);
  robot.mutable_position()->set_orientation(90.0);
  robot.set_turnon(true);
  FirasimPacket read;
  const std::string bytes = packet.SerializeAsString();
  ASSERT_TRUE(decode_firasim(bytes_of(bytes), read).ok());
  ASSERT_EQ(read.commands.size(), 1u);
  EXPECT_EQ(read.commands[0].team, FirasimTeam::kYellow);
  EXPECT_EQ(read.commands[0].left_radps, 12.5);
  EXPECT_EQ(read.commands[0].right_radps, 0.0);
  ASSERT_TRUE(read.ball);
  EXPECT_EQ(read.ball->x_m, 0.5);
  EXPECT_EQ(read.ball->vy_mps, -1.5);
  ASSERT_EQ(read.placements.size(), 1u);
  EXPECT_EQ(read.placements[0].team, FirasimTeam::kBlue);
  EXPECT_EQ(read.placements[0].id, 1);
  EXPECT_EQ(read.placements[0].y_m, 0.25);
  EXPECT_DOUBLE_EQ(read.placements[0].theta_rad, std::numbers::pi / 2) << "the packet has degrees";
  EXPECT_TRUE(read.placements[0].is_on);
  EXPECT_EQ(encoded(read), bytes);
}

TEST(FirasimPackets, ImpossibleValuesAreRefusedAsAWhole) {
  FirasimPacket read;
  pb::Packet packet;
  packet.mutable_replace()->mutable_ball()->set_x(std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(decode_firasim(bytes_of(packet.SerializeAsString()), read).code(), ErrorCode::kOutOfRange);
  packet.Clear();
  packet.mutable_replace()->add_robots()->mutable_position()->set_robot_id(128);
  EXPECT_EQ(decode_firasim(bytes_of(packet.SerializeAsString()), read).text(),
            "replace.robots[0].position.robot_id = 128 is above 127");
}

}  // namespace
}  // namespace touchline::hal
