#include "hal/linux/network/network_address.h"

#include <gtest/gtest.h>

namespace touchline::hal {
namespace {

TEST(NetworkAddress, ReadsAndWritesAddresses) {
  for (const char* const text : {"udp://224.5.23.2:10006", "udp://192.168.1.20:20011%eth0", "udp://0.0.0.0:1",
                                 "udp://255.255.255.255:65535", "unix:///run/touchline/json.sock"}) {
    const Result<NetworkAddress> address = parse_network_address(text);
    ASSERT_TRUE(address.ok()) << address.text();
    EXPECT_EQ(address.value().text(), text);
  }
  const NetworkAddress address = parse_network_address("udp://224.5.23.2:10006%eth0").value();
  EXPECT_EQ(address.ipv4, 0xe0051702U);
  EXPECT_EQ(address.port, 10006);
  EXPECT_EQ(address.interface, "eth0");
  EXPECT_TRUE(address.is_multicast());
  EXPECT_FALSE(parse_network_address("udp://223.255.255.255:1").value().is_multicast());
  EXPECT_FALSE(parse_network_address("udp://240.0.0.1:1").value().is_multicast());
  EXPECT_EQ(parse_network_address("udp://localhost:9870").value().text(), "udp://127.0.0.1:9870");
}

TEST(NetworkAddress, NamesThePartThatIsWrong) {
  const auto error = [](const char* text) { return parse_network_address(text).text(); };
  const std::string expected = "expected udp://ADDRESS:PORT, udp://ADDRESS:PORT%INTERFACE or unix:///PATH";
  EXPECT_EQ(error("224.5.23.2:10006"), "\"224.5.23.2:10006\": " + expected);
  EXPECT_EQ(error("tcp://1.2.3.4:5"), "\"tcp://1.2.3.4:5\": " + expected);
  EXPECT_EQ(error(""), "\"\": " + expected);
  EXPECT_EQ(error("udp://1.2.3.4"), "\"udp://1.2.3.4\": the port is missing; " + expected);
  EXPECT_EQ(error("udp://1.2.3:5"), "\"udp://1.2.3:5\": \"1.2.3\" is not an IPv4 address in numbers");
  EXPECT_EQ(error("udp://1.2.3.256:5"), "\"udp://1.2.3.256:5\": \"1.2.3.256\" is not an IPv4 address in numbers");
  EXPECT_EQ(error("udp://1.2.3.4.5:5"), "\"udp://1.2.3.4.5:5\": \"1.2.3.4.5\" is not an IPv4 address in numbers");
  EXPECT_EQ(error("udp://field-pc:5"), "\"udp://field-pc:5\": \"field-pc\" is not an IPv4 address in numbers");
  EXPECT_EQ(error("udp://[::1]:5"), "\"udp://[::1]:5\": IPv6 is not supported; use an IPv4 address");
  for (const char* const port : {"0", "65536", "", "80x", "-1", " 80", "99999999999999999999"}) {
    const std::string text = "udp://1.2.3.4:" + std::string(port);
    EXPECT_EQ(error(text.c_str()), "\"" + text + "\": the port \"" + port + "\" is not between 1 and 65535");
  }
  EXPECT_EQ(error("udp://1.2.3.4:5%"), "\"udp://1.2.3.4:5%\": the name of the interface after % is missing");
  EXPECT_NE(error("udp://1.2.3.4:5%a_name_too_long_for_linux").find("cannot be the name of an interface"),
            std::string::npos);
  EXPECT_EQ(error("unix://run/x"), "\"unix://run/x\": the path must be absolute: unix:///PATH");
  EXPECT_EQ(error("unix:///run/"), "\"unix:///run/\": the path names a folder; name a file");
  EXPECT_NE(error(("unix:///" + std::string(107, 'x')).c_str()).find("at most 107 bytes"), std::string::npos);
  EXPECT_TRUE(parse_network_address("unix:///" + std::string(106, 'x')).ok());
}

TEST(NetworkRange, ContainsItsAddresses) {
  const NetworkRange one = parse_network_range("192.168.1.20").value();
  EXPECT_TRUE(one.contains(0xc0a80114));
  EXPECT_FALSE(one.contains(0xc0a80115));
  const NetworkRange network = parse_network_range("192.168.1.0/24").value();
  EXPECT_TRUE(network.contains(0xc0a80100));
  EXPECT_TRUE(network.contains(0xc0a801ff));
  EXPECT_FALSE(network.contains(0xc0a80200));
  EXPECT_TRUE(parse_network_range("0.0.0.0/0").value().contains(0xffffffff));
  for (const char* const text : {"", "192.168.1", "192.168.1.0/33", "192.168.1.0/", "192.168.1.0/x", "pc"}) {
    EXPECT_FALSE(parse_network_range(text).ok()) << text;
  }
}

}  // namespace
}  // namespace touchline::hal
