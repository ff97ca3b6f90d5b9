#include <gtest/gtest.h>

#include <fstream>
#include <span>
#include <sstream>
#include <string>
#include <vector>

#include "tests/radio/touchline_packets.h"

namespace touchline {
namespace {

// Lines of two-digit hexadecimal numbers between ``` fences of docs/radio.md. A fence with a language has no packets.
std::vector<std::string> examples_of_the_page() {
  std::ifstream page(TOUCHLINE_RADIO_PAGE);
  std::vector<std::string> examples;
  bool fenced = false, has_packets = false;
  for (std::string line; std::getline(page, line);) {
    if (line.starts_with("```")) {
      fenced = !fenced;
      has_packets = fenced && line == "```";
    } else if (has_packets) {
      examples.push_back(line);
    }
  }
  return examples;
}

std::string hexadecimal(std::span<const std::byte> packet) {
  constexpr const char* kDigits = "0123456789ABCDEF";
  std::string text;
  for (const std::byte byte : packet) {
    const auto value = std::to_integer<std::size_t>(byte);
    if (!text.empty()) text += ' ';
    text += kDigits[value / 16];
    text += kDigits[value % 16];
  }
  return text;
}

TEST(RadioPage, ShowsThePacketsOfTheCode) {
  Commands commands;
  commands.stop = false;
  commands.robots.push_back({0, {}, {0.5f, -0.25f}});
  commands.robots.push_back({3, {}, {1.234f, 1.234f}});
  std::vector<std::string> sent;
  Packet packet;
  ASSERT_TRUE(encode(commands, 42, packet).ok());
  sent.push_back(hexadecimal({packet.data(), packet.size()}));
  commands.stop = true;
  ASSERT_TRUE(encode(commands, 43, packet).ok());
  sent.push_back(hexadecimal({packet.data(), packet.size()}));
  commands.robots.clear();
  ASSERT_TRUE(encode(commands, 44, packet).ok());
  sent.push_back(hexadecimal({packet.data(), packet.size()}));
  commands.stop = false;
  commands.robots.push_back({0, {}, {0.5f, -0.25f}});
  commands.robots.push_back({3, {}, {1.234f, 1.234f}});
  ASSERT_TRUE(encode(commands, 42, packet, 7).ok());
  sent.push_back(hexadecimal({packet.data(), packet.size()}));
  commands.robots.clear();
  commands.stop = true;
  ASSERT_TRUE(encode(commands, 43, packet, 7).ok());
  sent.push_back(hexadecimal({packet.data(), packet.size()}));
  sent.push_back(hexadecimal(encode_telemetry({3, 17, 7.412f, 98})));
  EXPECT_EQ(examples_of_the_page(), sent);
}

TEST(RadioPage, NamesThePacketSizesOfTheCode) {
  std::ifstream page(TOUCHLINE_RADIO_PAGE);
  std::stringstream text;
  text << page.rdbuf();
  EXPECT_NE(text.str().find("8 + 5 n bytes: 33 for five robots"), std::string::npos);
  EXPECT_NE(text.str().find("63 for eleven"), std::string::npos);
  EXPECT_EQ(packet_bytes(5), 33u);
  EXPECT_EQ(packet_bytes(kMaxRobotsPerTeam), 63u);
  EXPECT_NE(text.str().find("9 + 5 n bytes in version 2"), std::string::npos);
  EXPECT_EQ(packet_bytes(kMaxRobotsPerTeam, 7), 64u);
}

}  // namespace
}  // namespace touchline
