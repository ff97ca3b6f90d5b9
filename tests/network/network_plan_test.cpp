#include "firmware/network/network_plan.h"

#include <gtest/gtest.h>

namespace touchline::network {
namespace {

using config::InputProtocol;
using config::OutputProtocol;

class NetworkPlanTest : public ::testing::Test {
 protected:
  NetworkPlan plan() {
    const Result<NetworkPlan> planned = plan_network(board_, where_, options_);
    EXPECT_TRUE(planned.ok()) << planned.text();
    return planned.ok() ? planned.value() : NetworkPlan();
  }
  std::string error() { return plan_network(board_, where_, options_).text(); }

  config::NetworkSettings board_;
  config::Locations where_{"board.toml"};
  NetworkOptions options_;
};

TEST_F(NetworkPlanTest, NothingByDefault) { EXPECT_TRUE(plan().empty()); }

TEST_F(NetworkPlanTest, UsualAddresses) {
  options_.publish = {"ssl-vision", "ssl-tracked", "firasim", "json"};
  options_.accept = {"firasim", "json"};
  options_.referee = {"ssl"};
  const NetworkPlan planned = plan();
  ASSERT_EQ(planned.outputs.size(), 4U);
  EXPECT_EQ(describe(planned.outputs[0]), "ssl-vision to udp://224.5.23.2:10006, every frame");
  EXPECT_EQ(describe(planned.outputs[1]), "ssl-tracked to udp://224.5.23.2:10010, every frame");
  EXPECT_EQ(describe(planned.outputs[2]), "firasim to udp://224.0.0.1:10002, every frame");
  EXPECT_EQ(describe(planned.outputs[3]), "json to udp://127.0.0.1:9870, every frame");
  ASSERT_EQ(planned.inputs.size(), 3U);
  EXPECT_EQ(describe(planned.inputs[0]),
            "firasim from udp://0.0.0.0:20011, of this computer, at most 1000 messages a second from each");
  EXPECT_EQ(name_of(planned.inputs[1]), "json from udp://0.0.0.0:20012");
  EXPECT_EQ(name_of(planned.inputs[2]), "ssl-referee from udp://224.5.23.1:10003");
  options_.referee = {"vsss"};
  EXPECT_EQ(name_of(plan().inputs[2]), "vsss-referee from udp://224.5.23.2:10003");
}

TEST_F(NetworkPlanTest, FileAndCommandLineAddUp) {
  config::OutputSettings output;
  output.protocol = OutputProtocol::kSslVision;
  output.interface = "eth0";
  output.rate_hz = 30.0;
  board_.output = {output};
  config::InputSettings input;
  input.protocol = InputProtocol::kFirasim;
  input.senders = {"192.168.1.20", "10.0.0.0/8"};
  board_.input = {input};
  options_.publish = {"ssl-vision", "json=unix:///run/t.sock", "json", "json=udp://10.1.1.1:5%wlan0"};
  options_.accept = {"firasim"};
  const NetworkPlan planned = plan();
  ASSERT_EQ(planned.outputs.size(), 4U);
  EXPECT_EQ(describe(planned.outputs[0]), "ssl-vision to udp://224.5.23.2:10006%eth0, at most 30 Hz");
  EXPECT_EQ(name_of(planned.outputs[1]), "json to unix:///run/t.sock");
  EXPECT_EQ(name_of(planned.outputs[2]), "json to udp://127.0.0.1:9870") << "the usual address beside another one";
  EXPECT_EQ(name_of(planned.outputs[3]), "json to udp://10.1.1.1:5%wlan0");
  ASSERT_EQ(planned.inputs.size(), 1U);
  EXPECT_EQ(describe(planned.inputs[0]),
            "firasim from udp://0.0.0.0:20011, of this computer and 192.168.1.20 and 10.0.0.0/8, at most 1000 messages "
            "a second from each");
  EXPECT_TRUE(planned.inputs[0].senders[1].contains(0x0a010203));
}

TEST_F(NetworkPlanTest, ErrorsNameOptionOrKey) {
  config::OutputSettings output;
  output.protocol = OutputProtocol::kFirasim;
  output.address = "unix:///run/x";
  config::OutputSettings twice;
  twice.address = "udp://127.0.0.1:5%lo";
  twice.interface = "lo";
  board_.output = {output, twice};
  config::InputSettings input;
  input.senders = {"field-pc"};
  board_.input = {input};
  where_.note("network.output[0].address", "board.toml:7");
  options_.publish = {"sslvision", "json=127.0.0.1:5", "json=udp://0.0.0.0:5"};
  options_.accept = {"ssl-vision"};
  options_.referee = {"ssl", "vsss"};
  const std::vector<std::string> expected = {
      "board.toml:7: network.output[0].address: only json can use a unix socket; use udp://ADDRESS:PORT",
      "board.toml: network.output[1].interface: the address names an interface already",
      "board.toml: network.input[0].senders: \"field-pc\": expected an IPv4 address or a network such as "
      "192.168.1.0/24",
      "--publish sslvision: \"sslvision\" is none of ssl-vision, ssl-tracked, firasim, json, "
      "vsss-placement",
      "--publish json=127.0.0.1:5: \"127.0.0.1:5\": expected udp://ADDRESS:PORT, udp://ADDRESS:PORT%INTERFACE or "
      "unix:///PATH",
      "--publish json=udp://0.0.0.0:5: 0.0.0.0 is no destination; name a computer or a multicast group",
      "--accept ssl-vision: \"ssl-vision\" is none of firasim, json",
      "--referee vsss: there is a referee already: ssl-referee"};
  std::istringstream lines(error());
  std::vector<std::string> found;
  for (std::string line; std::getline(lines, line);) found.push_back(line);
  EXPECT_EQ(found, expected);
}

TEST_F(NetworkPlanTest, PlacementNeedsAVsssReferee) {
  options_.publish = {"vsss-placement"};
  EXPECT_EQ(error(), "--publish vsss-placement: vsss-placement answers a VSSS referee; add --referee vsss");
  options_.referee = {"ssl"};
  EXPECT_EQ(error(), "--publish vsss-placement: vsss-placement answers a VSSS referee; add --referee vsss");
  options_.referee = {"vsss"};
  EXPECT_EQ(name_of(plan().outputs[0]), "vsss-placement to udp://224.5.23.2:10004");
  options_.publish.clear();
  options_.referee.clear();
  config::OutputSettings output;
  output.protocol = OutputProtocol::kVsssPlacement;
  board_.output = {output};
  where_.note("network.output[0].protocol", "board.toml:7");
  EXPECT_EQ(error(),
            "board.toml:7: network.output[0].protocol: vsss-placement answers a VSSS referee; add --referee vsss");
}

TEST_F(NetworkPlanTest, OptionsNameSenders) {
  config::InputSettings input;
  input.protocol = InputProtocol::kJson;
  input.senders = {"192.168.1.20"};
  board_.input = {input};
  where_.note("network.input[0]", "board.toml:7");
  options_.accept = {"json,from=192.168.1.21", "firasim"};
  options_.referee = {"ssl=udp://224.5.23.1:10003%eth0,from=192.168.1.5,from=10.0.0.0/8"};
  const NetworkPlan planned = plan();
  ASSERT_EQ(planned.inputs.size(), 3U);
  EXPECT_EQ(
      describe(planned.inputs[0]),
      "json from udp://0.0.0.0:20012, of this computer and 192.168.1.20 and 192.168.1.21, at most 1000 messages a "
      "second from each");
  EXPECT_EQ(
      describe(planned.inputs[2]),
      "ssl-referee from udp://224.5.23.1:10003%eth0, of this computer and 192.168.1.5 and 10.0.0.0/8, at most 1000 "
      "messages a second from each");
  EXPECT_TRUE(planned.inputs[2].senders[1].contains(0x0a010203));
  EXPECT_EQ(how_to_permit(planned.inputs[0], "1.2.3.4"), "add 1.2.3.4 to network.input[0].senders in board.toml:7");
  EXPECT_EQ(how_to_permit(planned.inputs[1], "1.2.3.4"), "write --accept firasim,from=1.2.3.4");

  options_ = {{"json,from=1.2.3.4"}, {}, {"ssl,from=here"}};
  EXPECT_EQ(error(),
            "--publish json,from=1.2.3.4: an output has no senders\n"
            "--referee ssl,from=here: \"here\": expected an IPv4 address or a network such as 192.168.1.0/24");
}

TEST_F(NetworkPlanTest, AddressesAreListedOnce) {
  options_.publish = {"json=udp://127.0.0.1:5", "json=udp://127.0.0.1:5"};
  options_.accept = {"json=udp://0.0.0.0:6", "firasim=udp://0.0.0.0:6"};
  EXPECT_EQ(error(),
            "--publish json=udp://127.0.0.1:5: udp://127.0.0.1:5 is listed twice\n"
            "--accept firasim=udp://0.0.0.0:6: udp://0.0.0.0:6 is listed twice");
}

}  // namespace
}  // namespace touchline::network
