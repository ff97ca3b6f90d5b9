// Layouts of the team file for robots that no preset describes, written with only the named source at hand.
#include "core/radio/packet.h"
#include "core/radio/packet_parser.h"
#include "firmware/config/resolve_radio.h"
#include "tests/config/config_files.h"
#include "tests/results.h"

namespace touchline::config {
namespace {

class OwnRadio : public ConfigFiles {
 protected:
  Result<void> load_with(const std::string& radio) {
    write("team.toml", read(path("team.toml")) + radio);
    return load({"control.drive.wheel_base_m=0.0625", "control.drive.max_wheel_speed_mps=2.0"});
  }
  // One packet for each robot, and what the robot reads.
  std::vector<std::string> packets(const Commands& commands) {
    const PacketLayout& layout = configuration_->pipeline.radio;
    OutgoingPackets encoded;
    EXPECT_TRUE(encode(layout, commands, {commands.stop, false, 1, {}}, encoded).ok());
    std::vector<std::string> out;
    for (std::size_t i = 0; i < encoded.size(); ++i) {
      std::string bytes;
      for (const std::byte byte : encoded[i].packet) bytes += std::to_integer<char>(byte);
      out.push_back(bytes);
      ParsedPacket read;
      const std::span<const std::byte> packet{encoded[i].packet.data(), encoded[i].packet.size()};
      EXPECT_TRUE(decode_packet(layout, packet, layout.receivers[i].id, read).ok());
      if (read.commands.robots.size() != 1U) {
        ADD_FAILURE() << read.commands.robots.size() << " robots";
        continue;
      }
      const WheelSpeeds sent = commands.stop ? WheelSpeeds{} : commands.robots[i].wheels;
      EXPECT_NEAR(read.commands.robots[0].wheels.left_mps, sent.left_mps, 0.01);
      EXPECT_NEAR(read.commands.robots[0].wheels.right_mps, sent.right_mps, 0.01);
    }
    return out;
  }
  static Commands drive(WheelSpeeds first, WheelSpeeds second) {
    Commands commands;
    commands.stop = false;
    commands.robots.push_back({0, {}, first});
    commands.robots.push_back({1, {}, second});
    return commands;
  }
};

// felipersotero/vsss-robots, esp-master/esp-master.ino (f9490a7), esp-slave/esp-slave.ino (9a43817): nine characters.
TEST_F(OwnRadio, DescribesNineCharacters) {
  ASSERT_OK(load_with(R"(
[radio]
format = "own"
packet_for = "each"
field = [
  {value = "stop", type = "u8", codes = [102, 115]},
  {value = "right", type = "digits", width = 4, unit = "share", scale = 255, low = -255, high = 255},
  {value = "left", type = "digits", width = 4, unit = "share", scale = 255, low = -255, high = 255},
]
)"));
  Commands commands = drive({0.5f, -0.25f}, {2.0f, -2.0f});
  EXPECT_EQ(packets(commands), (std::vector<std::string>{"f-0320064", "f-2550255"}));
  commands.stop = true;
  EXPECT_EQ(packets(commands), (std::vector<std::string>{"s00000000", "s00000000"}));
}

// furgbol-old/VSS-AI-2019, arduino/arduino.ino, include/labels/labels.h (2246bba): the first byte has bit 7 set, and
// the signs of both speeds stand in bytes of their own. The units are not in the source.
TEST_F(OwnRadio, DescribesDirectionsInBytesOfTheirOwn) {
  ASSERT_OK(load_with(R"(
[radio]
format = "own"
packet_for = "each"
field = [
  {value = "id", type = "u8", offset = 128},
  {value = "forward", type = "u8", magnitude = true, unit = "cm/s", high = 127},
  {value = "turn", type = "u8", magnitude = true, unit = "rad/s", scale = 10, high = 127},
  {value = "forward-direction", type = "u8", codes = [3, 1]},
  {value = "turn-direction", type = "u8", codes = [1, 3]},
]
)"));
  EXPECT_EQ(packets(drive({0.25f, -0.25f}, {-0.75f, -0.25f})),
            (std::vector<std::string>{{'\x80', '\0', '\x50', '\3', '\3'}, {'\x81', '\x32', '\x50', '\1', '\1'}}));
  // A direction that the source does not define moves no robot.
  const std::array<std::byte, 5> wrong{std::byte{0x80}, std::byte{50}, std::byte{0}, std::byte{2}, std::byte{1}};
  ParsedPacket read;
  EXPECT_FALSE(decode_packet(configuration_->pipeline.radio, wrong, 0, read).ok());
}

// The same, for each wheel.
TEST_F(OwnRadio, DescribesADirectionOfEachWheel) {
  ASSERT_OK(load_with(R"(
[radio]
format = "own"
packet_for = "each"
field = [
  {value = "left", type = "u8", magnitude = true, unit = "cm/s"},
  {value = "right", type = "u8", magnitude = true, unit = "cm/s"},
  {value = "left-direction", type = "bits", bits = 1},
  {value = "right-direction", type = "bits", bits = 1, codes = [1, 0]},
  {value = "unused", type = "bits", bits = 6},
]
)"));
  EXPECT_EQ(packets(drive({0.5f, -0.25f}, {-0.75f, 0.25f})),
            (std::vector<std::string>{{'\x32', '\x19', '\0'}, {'\x4B', '\x19', '\3'}}));
}

}  // namespace
}  // namespace touchline::config
