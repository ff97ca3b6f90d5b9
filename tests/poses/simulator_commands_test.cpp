// The bytes of the radio formats firasim and grsim, read by protobuf's own library with the simulators' definitions.
#include <gtest/gtest.h>
#include <tests/network/firasim.pb.h>
#include <tests/network/grsim.pb.h>

#include <algorithm>
#include <string>

#include "hal/poses/firasim_packets.h"
#include "tests/config/radio_golden.h"

namespace touchline::hal {
namespace {

std::string bytes_of_hex(std::string_view hex) {
  std::string bytes;
  for (std::size_t i = 0; i + 1 < hex.size(); i += 3) {
    bytes += static_cast<char>(std::stoi(std::string(hex.substr(i, 2)), nullptr, 16));
  }
  return bytes;
}

const config::RadioGolden& golden(std::string_view preset) {
  return *std::find_if(config::kRadioGolden.begin(), config::kRadioGolden.end(),
                       [&](const config::RadioGolden& entry) { return entry.preset == preset; });
}

// Robots 1 to 3: (0.5, 0.5), (-0.25, 0.25) and (-0.75, -0.25) m/s of the left and right wheel.
TEST(SimulatorCommands, ProtobufJoinsTheMessagesOfFirasimsRobots) {
  const std::string bytes = bytes_of_hex(golden("firasim").drive[0]);
  fira_message::Packet packet;
  ASSERT_TRUE(packet.ParseFromString(bytes));
  ASSERT_EQ(packet.cmd().robot_commands_size(), 3);
  EXPECT_EQ(packet.cmd().robot_commands(2).id(), 3u);
  EXPECT_FALSE(packet.cmd().robot_commands(2).yellowteam());
  EXPECT_DOUBLE_EQ(packet.cmd().robot_commands(0).wheel_left(), 25.0) << "0.5 m/s on wheels of 20 mm";
  EXPECT_DOUBLE_EQ(packet.cmd().robot_commands(2).wheel_left(), -37.5);
  EXPECT_DOUBLE_EQ(packet.cmd().robot_commands(2).wheel_right(), -12.5);
  FirasimPacket read;
  ASSERT_TRUE(decode_firasim(std::as_bytes(std::span(bytes)), read).ok());
  EXPECT_EQ(read.commands.size(), 3u) << "nanopb joins them, too";
  ASSERT_TRUE(packet.ParseFromString(bytes_of_hex(golden("firasim").stop[0])));
  for (const fira_message::Command& command : packet.cmd().robot_commands()) {
    EXPECT_EQ(command.wheel_left(), 0.0);
    EXPECT_EQ(command.wheel_right(), 0.0);
  }
}

TEST(SimulatorCommands, GrsimGetsAPacketForEachRobot) {
  ASSERT_EQ(golden("grsim").drive.size(), 3u);
  grSim_Packet packet;
  ASSERT_TRUE(packet.ParseFromString(bytes_of_hex(golden("grsim").drive[2]))) << "with all required fields";
  EXPECT_FALSE(packet.commands().isteamyellow());
  ASSERT_EQ(packet.commands().robot_commands_size(), 1);
  const grSim_Robot_Command& command = packet.commands().robot_commands(0);
  EXPECT_EQ(command.id(), 3u);
  EXPECT_EQ(command.veltangent(), -0.5f);
  EXPECT_EQ(command.velnormal(), 0.0f);
  EXPECT_EQ(command.velangular(), 8.0f) << "0.5 m/s between wheels that are 62.5 mm apart";
  EXPECT_FALSE(command.wheelsspeed());
  EXPECT_EQ(command.kickspeedx(), 0.0f);
}

}  // namespace
}  // namespace touchline::hal
