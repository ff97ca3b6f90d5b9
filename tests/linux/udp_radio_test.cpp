// Over the loopback of this computer. Real interfaces: tests/network/radio_robots.
#include "hal/linux/network/udp_radio.h"

#include <gtest/gtest.h>
#include <sys/socket.h>

#include <array>
#include <string>
#include <vector>

#include "tests/results.h"

namespace touchline::hal {
namespace {

constexpr std::uint32_t kThisComputer = 0x7f000001;

Packet packet(std::string_view text) {
  Packet packet;
  for (const char character : text) packet.push_back(static_cast<std::byte>(character));
  return packet;
}

/// A robot with a socket of its own at 127.0.0.`number`.
class Robot {
 public:
  explicit Robot(std::uint32_t number) {
    sockaddr_in at = socket_address(0x7f000000 + number, 0);
    socklen_t size = sizeof(at);
    EXPECT_EQ(::bind(socket_.get(), reinterpret_cast<const sockaddr*>(&at), size), 0);
    EXPECT_EQ(::getsockname(socket_.get(), reinterpret_cast<sockaddr*>(&at), &size), 0);
    endpoint = {0x7f000000 + number, ntohs(at.sin_port)};
  }
  /// The datagrams that have arrived. Loopback delivers a datagram before sendto() returns.
  std::vector<std::string> received() {
    std::vector<std::string> texts;
    char block[512];
    socklen_t size = sizeof(from_);
    for (ssize_t count = 0; (count = ::recvfrom(socket_.get(), block, sizeof block, MSG_DONTWAIT,
                                                reinterpret_cast<sockaddr*>(&from_), &size)) >= 0;) {
      texts.emplace_back(block, static_cast<std::size_t>(count));
    }
    return texts;
  }
  /// Answers to where the last datagram came from.
  void answer(const std::string& text) {
    sockaddr_in to = from_;
    to.sin_addr.s_addr = htonl(kThisComputer);
    EXPECT_EQ(::sendto(socket_.get(), text.data(), text.size(), 0, reinterpret_cast<const sockaddr*>(&to), sizeof(to)),
              static_cast<ssize_t>(text.size()));
  }
  UdpEndpoint endpoint;

 private:
  Descriptor socket_{::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)};
  sockaddr_in from_{};
};

using Texts = std::vector<std::string>;

TEST(UdpRadio, SendsOneDatagramPerPacketToItsRobot) {
  Robot first(2), second(3), module(4);
  UdpRadioSettings settings;
  settings.robots[0] = first.endpoint;
  settings.robots[2] = second.endpoint;
  settings.common = module.endpoint;
  UdpRadio radio(settings);
  ASSERT_OK(radio.open());
  EXPECT_OK(radio.send(packet("a"), 0));
  EXPECT_OK(radio.send(packet("b"), 1));  // a robot without an address
  EXPECT_OK(radio.send(packet("c"), 2));
  EXPECT_OK(radio.send(packet("d"), kAllRobots));
  EXPECT_EQ(first.received(), Texts{"a"});
  EXPECT_EQ(second.received(), Texts{"c"});
  EXPECT_EQ(module.received(), (Texts{"b", "d"}));
  EXPECT_EQ(radio.counters().packets, 4U);
  EXPECT_EQ(radio.serve().value(), Duration::max());
  EXPECT_OK(radio.drain(Instant{}));
}

TEST(UdpRadio, APacketForAllReachesEachRobotIfThereIsNoCommonAddress) {
  Robot first(2), second(3);
  UdpRadioSettings settings;
  settings.robots[0] = first.endpoint;
  settings.robots[5] = second.endpoint;
  UdpRadio radio(settings);
  ASSERT_OK(radio.open());
  EXPECT_OK(radio.send(packet("stop"), kAllRobots));
  EXPECT_EQ(first.received(), Texts{"stop"});
  EXPECT_EQ(second.received(), Texts{"stop"});
  RadioRoutes routes;
  radio.add_routes(kAllRobots, routes);
  ASSERT_EQ(routes.size(), 2U);
  EXPECT_TRUE(routes[1].is_datagram);
  EXPECT_EQ(routes[1].port, second.endpoint.port);
}

TEST(UdpRadio, ARobotThatIsSwitchedOffIsCountedAndStopsNobody) {
  Robot on(2);
  UdpRadioSettings settings;
  settings.robots[0] = Robot(3).endpoint;  // closed again
  settings.robots[1] = on.endpoint;
  UdpRadio radio(settings);
  ASSERT_OK(radio.open());
  for (int i = 0; i < 100; ++i) {
    EXPECT_OK(radio.send(packet("off"), 0));
    EXPECT_OK(radio.send(packet("on"), 1));
  }
  EXPECT_EQ(on.received().size(), 100U);
  EXPECT_OK(radio.send(packet("off"), 0));  // reads what the network says about the one before
  EXPECT_EQ(radio.counters().unreachable, 100U);
  EXPECT_EQ(radio.counters().packets, 201U);
}

TEST(UdpRadio, TellsWhichRobotHasSentADatagram) {
  Robot first(2), second(3), third(3);  // two at one address
  UdpRadioSettings settings;
  settings.robots = {first.endpoint, second.endpoint, third.endpoint};
  UdpRadio radio(settings);
  ASSERT_OK(radio.open());
  for (std::size_t robot = 0; robot < 3; ++robot) ASSERT_OK(radio.send(packet("a"), robot));
  for (Robot* const robot : {&first, &second, &third}) robot->received();
  first.answer("one");
  first.answer("uno");
  second.answer("second");
  third.answer("the third");
  std::array<std::byte, 512> into{};
  std::array<std::size_t, 3> bytes{};
  std::size_t sender = 0;
  for (int i = 0; i < 3; ++i) {
    const Result<std::size_t> count = radio.receive(into, sender);
    ASSERT_OK(count);
    ASSERT_LT(sender, 3U);
    bytes[sender] += count.value();
  }
  EXPECT_EQ(bytes, (std::array<std::size_t, 3>{6, 6, 9}));
  EXPECT_EQ(radio.receive(into, sender).value(), 0U);
}

TEST(UdpRadio, ReceivesOnlyFromItsRobots) {
  Robot robot(2);
  UdpRadioSettings settings;
  settings.robots[0] = robot.endpoint;
  UdpRadio radio(settings);
  ASSERT_OK(radio.open());
  EXPECT_OK(radio.send(packet("a"), 0));
  robot.received();
  robot.answer("TR one");
  robot.answer("TR two");
  std::array<std::byte, 512> into{};
  const Result<std::size_t> count = radio.receive(into);
  ASSERT_OK(count);
  EXPECT_EQ(std::string(reinterpret_cast<const char*>(into.data()), count.value()), "TR oneTR two");
  EXPECT_EQ(radio.receive(into).value(), 0U);

  // The stranger knows the port from the robot.
  RadioRoutes routes;
  radio.add_routes(0, routes);
  sockaddr_in own{};
  socklen_t size = sizeof(own);
  ASSERT_EQ(::getsockname(routes[0].descriptor, reinterpret_cast<sockaddr*>(&own), &size), 0);
  own.sin_addr.s_addr = htonl(kThisComputer);
  const Descriptor hostile(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  const sockaddr_in from = socket_address(0x7f000009, 0);
  ASSERT_EQ(::bind(hostile.get(), reinterpret_cast<const sockaddr*>(&from), sizeof(from)), 0);
  ASSERT_EQ(::sendto(hostile.get(), "x", 1, 0, reinterpret_cast<const sockaddr*>(&own), sizeof(own)), 1);
  EXPECT_EQ(radio.receive(into).value(), 0U);
  EXPECT_EQ(radio.counters().received_bytes, 12U);
}

TEST(UdpRadio, TwoRadiosCannotShareALocalPort) {
  Robot robot(2);
  UdpRadioSettings settings;
  settings.robots[0] = robot.endpoint;
  settings.local_port = 41981;
  UdpRadio first(settings), second(settings);
  ASSERT_OK(first.open());
  EXPECT_NE(first.description().find("telemetry at port 41981"), std::string::npos) << first.description();
  const Result<void> opened = second.open();
  EXPECT_EQ(opened.code(), ErrorCode::kDeviceBusy);
  EXPECT_NE(opened.text().find("local port 41981: binding failed: Address already in use"), std::string::npos)
      << opened.text();
  EXPECT_EQ(second.send(packet("a")).code(), ErrorCode::kDisconnected);
}

TEST(UdpRadio, AMissingInterfaceIsNotFound) {
  UdpRadioSettings settings;
  settings.common = {kThisComputer, 41982};
  settings.interface = "touchline9";
  UdpRadio radio(settings);
  const Result<void> opened = radio.open();
  EXPECT_EQ(opened.code(), ErrorCode::kNotFound);
  EXPECT_NE(opened.text().find("there is no interface touchline9"), std::string::npos) << opened.text();
}

}  // namespace
}  // namespace touchline::hal
