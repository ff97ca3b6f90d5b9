#include "tools/programs/radio/packet_text.h"

#include <gtest/gtest.h>

#include "core/radio/packet.h"
#include "core/radio/telemetry.h"

namespace touchline::radio {
namespace {

Packet packet_for_robot_3() {
  Commands commands;
  commands.stop = false;
  RobotCommand robot;
  robot.id = 3;
  robot.wheels = {0.2f, -0.05f};
  commands.robots.push_back(robot);
  Packet packet;
  EXPECT_TRUE(encode(commands, 7, packet, 12).ok());
  return packet;
}

TEST(PacketText, NamesEachField) {
  const Packet packet = packet_for_robot_3();
  EXPECT_EQ(packet_text({packet.data(), packet.size() - kPacketCrcBytes}).find("version"), std::string::npos);
  const std::string text = packet_text({packet.data(), packet.size()});
  for (const char* line :
       {"54 4C           start \"TL\"", "02              version 2", "00              flags: none",
        "07              sequence number 7", "0C              team number 12", "01              1 robot",
        "03              robot 3", "C8 00           left wheel +0.200 m/s", "CE FF           right wheel -0.050 m/s",
        "checksum, right"}) {
    EXPECT_NE(text.find(line), std::string::npos) << line << "\n" << text;
  }
}

TEST(PacketText, ShowsAWrongChecksum) {
  Packet packet = packet_for_robot_3();
  packet.back() ^= std::byte{1};
  EXPECT_NE(packet_text({packet.data(), packet.size()}).find("checksum, WRONG"), std::string::npos);
}

TEST(PacketText, ShowsTelemetryBetweenOtherBytes) {
  RobotTelemetry telemetry;
  telemetry.id = 4;
  telemetry.battery_v = 7.5f;
  telemetry.link_percent = 98;
  const TelemetryPacket packet = encode_telemetry(telemetry);
  std::vector<std::byte> bytes{std::byte{0xAA}, kTelemetryMagic0};
  bytes.insert(bytes.end(), packet.begin(), packet.end());
  bytes.push_back(std::byte{0x01});
  const std::string text = telemetry_text(bytes);
  EXPECT_NE(text.find("battery 7.500 V"), std::string::npos) << text;
  EXPECT_NE(text.find("link 98 %"), std::string::npos) << text;
  EXPECT_NE(text.find("AA              no packet of a robot"), std::string::npos) << text;
  EXPECT_NE(text.find("01              no packet of a robot"), std::string::npos) << text;
}

}  // namespace
}  // namespace touchline::radio
