// Sockets of this computer: loopback and unix. Real interfaces: tests/network.
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <thread>

#include <gtest/gtest.h>

#include "hal/linux/network/descriptor.h"
#include "hal/linux/network/network_input.h"
#include "hal/linux/network/network_output.h"
#include "hal/linux/network/udp_input.h"

namespace touchline::hal {
namespace {

using namespace std::chrono_literals;

std::span<const std::byte> bytes_of(const std::string& text) { return std::as_bytes(std::span(text)); }

NetworkAddress address(const std::string& text) { return parse_network_address(text).value(); }

// The next message as text; "" after a second.
std::string receive(NetworkInput& input, ReceivedMessage* details = nullptr) {
  std::array<std::byte, 100> buffer{};
  for (int i = 0; i < 1000; ++i) {
    const Result<std::optional<ReceivedMessage>> message = input.receive(buffer);
    EXPECT_TRUE(message.ok()) << message.text();
    if (!message.ok()) return {};
    if (message.value()) {
      if (details != nullptr) *details = *message.value();
      return {reinterpret_cast<const char*>(buffer.data()), message.value()->size};
    }
    std::this_thread::sleep_for(1ms);
  }
  return {};
}

class UnixSocket : public ::testing::Test {
 protected:
  ~UnixSocket() override { std::filesystem::remove_all(folder_); }

  // A client that has connected.
  Descriptor client() {
    Descriptor socket(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
    sockaddr_un at{};
    at.sun_family = AF_UNIX;
    std::strcpy(at.sun_path, path_.c_str());
    EXPECT_EQ(::connect(socket.get(), reinterpret_cast<const sockaddr*>(&at), sizeof(at)), 0) << std::strerror(errno);
    return socket;
  }
  // A socket file to which nobody listens.
  void leave_stale_socket() {
    const Descriptor socket(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
    sockaddr_un at{};
    at.sun_family = AF_UNIX;
    std::strcpy(at.sun_path, path_.c_str());
    ASSERT_EQ(::bind(socket.get(), reinterpret_cast<const sockaddr*>(&at), sizeof(at)), 0);
  }

  const std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("touchline-socket-" + std::to_string(::getpid()));
  const bool made_ = std::filesystem::create_directories(folder_);
  const std::string path_ = (folder_ / "json.sock").string();
  const std::string url_ = "unix://" + path_;
};

TEST(UdpSocket, LoopbackCarriesMessages) {
  const auto input = make_network_input(address("udp://127.0.0.1:41970"));
  const auto output = make_network_output(address("udp://127.0.0.1:41970"));
  ASSERT_TRUE(output->open().ok());
  EXPECT_TRUE(output->send(bytes_of("nobody listens")).ok());
  ASSERT_TRUE(input->open().ok());
  EXPECT_TRUE(output->send(bytes_of("hello")).ok());
  ReceivedMessage details;
  EXPECT_EQ(receive(*input, &details), "hello");
  EXPECT_TRUE(details.is_local);
  EXPECT_TRUE(details.is_complete);
  EXPECT_EQ(details.sender, 0x7f000001U);
  EXPECT_NE(details.port, 0);
  EXPECT_TRUE(output->send(bytes_of(std::string(101, 'x'))).ok());
  EXPECT_EQ(receive(*input, &details).size(), 100U);
  EXPECT_FALSE(details.is_complete);
  EXPECT_TRUE(input->check().ok());

  const auto second = make_network_input(address("udp://127.0.0.1:41970"));
  const Result<void> opened = second->open();
  EXPECT_EQ(opened.code(), ErrorCode::kDeviceBusy);
  EXPECT_NE(opened.text().find("udp://127.0.0.1:41970: binding to the address failed: Address already in use"),
            std::string::npos)
      << opened.text();
}

TEST(UdpSocket, DroppedSendersTakeNoRoomInTheBuffer) {
  const NetworkAddress at = address("udp://0.0.0.0:41973");
  const auto sender = [](std::uint32_t ipv4) {
    Descriptor socket(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
    const sockaddr_in own = socket_address(ipv4, 0), there = socket_address(0x7f000001, 41973);
    EXPECT_EQ(::bind(socket.get(), reinterpret_cast<const sockaddr*>(&own), sizeof(own)), 0);
    EXPECT_EQ(::connect(socket.get(), reinterpret_cast<const sockaddr*>(&there), sizeof(there)), 0);
    return socket;
  };
  const Descriptor referee = sender(0x7f000002), flood = sender(0x7f000003);
  constexpr int kFlood = 20000, kHalts = 93;
  const auto send_all = [&] {
    for (int i = 0; i < kFlood; ++i) static_cast<void>(::send(flood.get(), "go", 2, MSG_DONTWAIT));
    for (int i = 0; i < kHalts; ++i) EXPECT_EQ(::send(referee.get(), "halt", 4, 0), 4);
  };
  const auto count_halts = [](UdpInput& input) {
    std::array<std::byte, 100> buffer{};
    int halts = 0;
    for (;;) {
      const Result<std::optional<ReceivedMessage>> message = input.receive(buffer);
      EXPECT_TRUE(message.ok()) << message.text();
      if (!message.ok() || !message.value()) return halts;
      halts += message.value()->sender == 0x7f000002 ? 1 : 0;
    }
  };
  UdpInput input(at);
  ASSERT_TRUE(input.open().ok());
  send_all();
  EXPECT_LT(count_halts(input), kHalts) << "the flood must fill the buffer";
  EXPECT_GT(input.drop_others_but({{0x7f000002, 32}}), 0U) << "for want of room";
  send_all();
  EXPECT_EQ(count_halts(input), kHalts);
  EXPECT_EQ(input.drop_others_but({{0x7f000002, 32}}), std::uint64_t{kFlood});
  // With this computer's addresses, all are accepted again.
  EXPECT_EQ(input.drop_others(std::vector<NetworkRange>{}), 0U);
  EXPECT_EQ(::send(flood.get(), "go", 2, 0), 2);
  EXPECT_EQ(receive(input), "go");
  input.drop_others(std::nullopt);
  EXPECT_EQ(::send(flood.get(), "go", 2, 0), 2);
  EXPECT_EQ(receive(input), "go");
}

TEST(UdpSocket, SeveralProgramsListenToAMulticastGroup) {
  const std::string group = "udp://239.255.41.1:41971%lo";
  const auto first = make_network_input(address(group)), second = make_network_input(address(group));
  const auto output = make_network_output(address(group));
  for (const auto& input : {first.get(), second.get()}) {
    const Result<void> opened = input->open();
    ASSERT_TRUE(opened.ok()) << opened.text();
  }
  ASSERT_TRUE(output->open().ok());
  const Result<void> sent = output->send(bytes_of("to all"));
  ASSERT_TRUE(sent.ok()) << sent.text();
  EXPECT_EQ(receive(*first), "to all");
  EXPECT_EQ(receive(*second), "to all");
}

TEST(UdpSocket, MissingInterfaceIsNamed) {
  for (const char* const text : {"udp://239.255.41.1:41972%none0", "udp://127.0.0.1:41972%none0"}) {
    const std::string expected = std::string(text) + ": there is no interface none0; `ip link` lists them";
    EXPECT_EQ(make_network_input(address(text))->open().text(), expected);
    EXPECT_EQ(make_network_output(address(text))->open().text(), expected);
  }
}

TEST_F(UnixSocket, EveryProgramThatConnectsReadsLines) {
  const auto output = make_network_output(address(url_));
  ASSERT_TRUE(output->open().ok());
  EXPECT_TRUE(output->send(bytes_of("nobody\n")).ok());
  const Descriptor first = client(), second = client();
  ASSERT_TRUE(output->send(bytes_of("line 1\n")).ok());
  ASSERT_TRUE(output->send(bytes_of("line 2\n")).ok());
  for (const Descriptor* const socket : {&first, &second}) {
    std::array<char, 100> text{};
    EXPECT_EQ(::read(socket->get(), text.data(), text.size()), 14);
    EXPECT_STREQ(text.data(), "line 1\nline 2\n");
  }
  output->close();
  EXPECT_FALSE(std::filesystem::exists(path_));
}

TEST_F(UnixSocket, SlowProgramLosesWholeLines) {
  const auto output = make_network_output(address(url_));
  ASSERT_TRUE(output->open().ok());
  const Descriptor slow = client();
  constexpr int kLines = 200;
  const std::string rest = std::string(10000, 'x') + "\n";
  for (int i = 0; i < kLines; ++i) ASSERT_TRUE(output->send(bytes_of(std::to_string(i) + " " + rest)).ok());
  EXPECT_GT(output->dropped(), 0U);
  EXPECT_LT(output->dropped(), static_cast<std::uint64_t>(kLines));
  // What it reads now are whole lines, in order.
  std::string received;
  std::array<char, 65536> part{};
  int more = 5;  // the rest of a line that was cut comes first
  for (;;) {
    const ssize_t size = ::recv(slow.get(), part.data(), part.size(), MSG_DONTWAIT);
    if (size <= 0) break;
    received.append(part.data(), static_cast<std::size_t>(size));
    if (more-- > 0) static_cast<void>(output->send(bytes_of("9999 " + rest)));
  }
  std::istringstream lines(received);
  int last = -1, count = 0;
  for (std::string line; std::getline(lines, line) && !lines.eof(); ++count) {
    const int number = std::stoi(line);
    ASSERT_GE(number, last);
    last = number;
    ASSERT_EQ(line, std::to_string(number) + " " + rest.substr(0, 10000));
  }
  EXPECT_GT(count, 2);
}

TEST_F(UnixSocket, LinesBecomeMessages) {
  const auto input = make_network_input(address(url_));
  ASSERT_TRUE(input->open().ok());
  const Descriptor first = client();
  const std::string text = "a message\nanother\nunfin";
  ASSERT_EQ(::write(first.get(), text.data(), text.size()), static_cast<ssize_t>(text.size()));
  ReceivedMessage details;
  EXPECT_EQ(receive(*input, &details), "a message");
  EXPECT_TRUE(details.is_local);
  EXPECT_EQ(receive(*input), "another");
  {
    const Descriptor second = client();
    ASSERT_EQ(::write(second.get(), "last words\n", 11), 11);
  }
  EXPECT_EQ(receive(*input), "last words") << "of a program that has gone";
  ASSERT_EQ(::write(first.get(), "ished\n", 6), 6);
  EXPECT_EQ(receive(*input), "unfinished");
  const std::string long_line = std::string(20000, 'x') + "\nshort\n";
  ASSERT_EQ(::write(first.get(), long_line.data(), long_line.size()), static_cast<ssize_t>(long_line.size()));
  receive(*input, &details);
  EXPECT_FALSE(details.is_complete);
  EXPECT_EQ(receive(*input, &details), "short");
  EXPECT_TRUE(details.is_complete);
}

TEST_F(UnixSocket, ReplacesTheSocketOfADeadProcessOnly) {
  leave_stale_socket();
  const auto output = make_network_output(address(url_));
  const Result<void> opened = output->open();
  EXPECT_TRUE(opened.ok()) << opened.text();

  const auto second = make_network_output(address(url_));
  EXPECT_EQ(second->open().text(), url_ + ": another process listens there; remove it or choose another path");
  output->close();
  EXPECT_FALSE(std::filesystem::exists(path_));

  std::ofstream(path_) << "precious";
  EXPECT_EQ(output->open().text(), url_ + ": the file exists and is no socket; remove it or choose another path");
  EXPECT_EQ(std::filesystem::file_size(path_), 8U);

  EXPECT_EQ(make_network_output(address("unix:///nowhere/x"))->open().code(), ErrorCode::kNotFound);
}

TEST_F(UnixSocket, FileOfAnotherListenerStays) {
  const auto output = make_network_output(address(url_));
  ASSERT_TRUE(output->open().ok());
  ASSERT_EQ(::unlink(path_.c_str()), 0);
  leave_stale_socket();
  output->close();
  EXPECT_TRUE(std::filesystem::exists(path_));
}

}  // namespace
}  // namespace touchline::hal
