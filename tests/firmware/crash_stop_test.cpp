// However the process ends, the last packets that the robots receive are stop packets.
#include "firmware/crash_stop.h"

#include <fcntl.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>
#include <array>
#include <bitset>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "firmware/radio_group.h"
#include "hal/linux/monotonic_clock.h"
#include "hal/linux/network/udp_radio.h"
#include "hal/linux/network/udp_socket.h"
#include "tests/radio/touchline_packets.h"

namespace touchline {
namespace {

struct Received {
  bool stop = false;
  std::uint8_t sequence = 0;
};

struct Outcome {
  int status = -1;  // of waitpid()
  std::vector<Received> packets;
};

/// Runs tests/firmware/crash_program.cpp on one end of a pseudo terminal; reads the other end as a robot does.
Outcome run(const std::string& ending, const std::vector<std::string>& ports = {}) {
  Outcome outcome;
  const int robots = ::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
  EXPECT_TRUE(robots >= 0 && ::grantpt(robots) == 0 && ::unlockpt(robots) == 0);
  const std::string device = ::ptsname(robots);
  const pid_t child = ::fork();
  if (child == 0) {
    std::vector<std::string> arguments{TOUCHLINE_CRASH_PROGRAM, device, ending};
    arguments.insert(arguments.end(), ports.begin(), ports.end());
    std::vector<char*> pointers;
    for (std::string& argument : arguments) pointers.push_back(argument.data());
    pointers.push_back(nullptr);
    ::execv(TOUCHLINE_CRASH_PROGRAM, pointers.data());
    ::_exit(99);
  }
  std::vector<std::byte> bytes;
  std::byte block[4096];
  bool opened = false;
  for (int waited = 0; waited < 1000;) {  // 20 s without a byte
    pollfd line{robots, POLLIN, 0};
    ::poll(&line, 1, 20);
    const ssize_t count = (line.revents & POLLIN) != 0 ? ::read(robots, block, sizeof block) : 0;
    if (count > 0) {
      bytes.insert(bytes.end(), block, block + count);
      opened = true;
      waited = 0;
      continue;
    }
    if ((line.revents & POLLHUP) != 0 && opened) break;  // the program has ended, and all bytes are read
    if (::waitpid(child, &outcome.status, WNOHANG) == child && !opened) break;
    ++waited;
    if ((line.revents & POLLHUP) != 0) ::usleep(20000);  // not opened yet
  }
  if (opened) ::waitpid(child, &outcome.status, 0);
  ::close(robots);
  // As the robots of the program's team receive them.
  CommandStream stream(7);
  Commands commands;
  Received packet;
  for (const std::byte byte : bytes) {
    stream.push(byte);
    while (stream.next(commands, packet.sequence)) {
      packet.stop = commands.stop;
      outcome.packets.push_back(packet);
    }
  }
  EXPECT_EQ(stream.foreign_packets(), 0U) << "a packet has another team number";
  return outcome;
}

/// Expects that robots were driven before, and that the last four packets or more are stop packets in order.
void expect_stopped(const Outcome& outcome) {
  std::size_t driving = 0, last_stops = 0;
  for (const Received& packet : outcome.packets) {
    driving += packet.stop ? 0 : 1;
    last_stops = packet.stop ? last_stops + 1 : 0;
  }
  EXPECT_GE(driving, 15U);
  EXPECT_LE(driving, 22U) << "the loop sends no packet after the stop packets of another thread began";
  EXPECT_GE(last_stops, 4U) << "of " << outcome.packets.size() << " packets";
  for (std::size_t i = outcome.packets.size() - std::min<std::size_t>(last_stops, 4); i < outcome.packets.size(); ++i) {
    EXPECT_GE(static_cast<std::uint8_t>(outcome.packets[i].sequence - outcome.packets[i - 1].sequence), 0) << i;
  }
}

class CrashStop : public ::testing::TestWithParam<std::pair<const char*, int>> {};

TEST_P(CrashStop, RobotsAreStoppedBeforeTheSignalEndsTheProcess) {
  const auto& [ending, signal] = GetParam();
  const Outcome outcome = run(ending);
  ASSERT_TRUE(WIFSIGNALED(outcome.status)) << outcome.status;
  EXPECT_EQ(WTERMSIG(outcome.status), signal);
  expect_stopped(outcome);
}

INSTANTIATE_TEST_SUITE_P(Endings, CrashStop,
                         ::testing::Values(std::pair{"abort", SIGABRT}, std::pair{"assertion", SIGABRT},
                                           std::pair{"exception-in-loop", SIGABRT},
                                           std::pair{"exception-in-thread", SIGABRT}, std::pair{"quit", SIGQUIT},
                                           std::pair{"segmentation-fault", SIGSEGV},
                                           std::pair{"stack-overflow", SIGSEGV}),
                         [](const auto& ending) {
                           std::string name = ending.param.first;
                           name.erase(std::remove(name.begin(), name.end(), '-'), name.end());
                           return name;
                         });

/// A robot that receives datagrams at a free port of this computer.
class NetworkRobot {
 public:
  NetworkRobot() {
    sockaddr_in at = hal::socket_address(0x7f000001, 0);
    socklen_t size = sizeof(at);
    EXPECT_EQ(::bind(socket_.get(), reinterpret_cast<const sockaddr*>(&at), size), 0);
    EXPECT_EQ(::getsockname(socket_.get(), reinterpret_cast<sockaddr*>(&at), &size), 0);
    port_ = std::to_string(ntohs(at.sin_port));
  }
  [[nodiscard]] const std::string& port() const { return port_; }
  std::vector<std::byte> received_bytes() {
    std::vector<std::byte> all;
    std::byte block[512];
    for (ssize_t count = 0; (count = ::recv(socket_.get(), block, sizeof block, MSG_DONTWAIT)) > 0;) {
      all.insert(all.end(), block, block + count);
    }
    return all;
  }
  std::vector<Received> receive() {
    std::vector<Received> received;
    CommandStream stream(7);
    std::byte block[512];
    for (ssize_t count = 0; (count = ::recv(socket_.get(), block, sizeof block, MSG_DONTWAIT)) > 0;) {
      for (ssize_t i = 0; i < count; ++i) stream.push(block[i]);
      Commands commands;
      Received packet;
      EXPECT_TRUE(stream.next(commands, packet.sequence)) << "a datagram is not a whole packet";
      packet.stop = commands.stop;
      received.push_back(packet);
    }
    return received;
  }

 private:
  hal::Descriptor socket_{::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)};
  std::string port_;
};

TEST(CrashStopOfSeveralRadios, EveryPortAndRobotIsStopped) {
  for (const char* const ending : {"segmentation-fault", "exception-in-thread", "exit"}) {
    SCOPED_TRACE(ending);
    NetworkRobot first, second;
    // The third robot is switched off: the network's messages about it must not cost the others their packets.
    const std::string off = NetworkRobot().port();
    const Outcome outcome = run(ending, {off, first.port(), second.port()});
    expect_stopped(outcome);
    expect_stopped({0, first.receive()});
    expect_stopped({0, second.receive()});
  }
}

/// Calls `crash` in a process of its own, because the stop packets of a process are sent once.
template <class Crash>
void in_another_process(Crash crash) {
  const pid_t child = ::fork();
  if (child == 0) {
    crash();
    ::_exit(0);
  }
  int status = -1;
  EXPECT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << status;
}

/// A serial port whose robots note when each packet arrives: a socket with the kernel's time stamps, because a reader
/// may be late.
class TimedLine {
 public:
  struct Arrival {
    double at_s = 0.0;
    std::size_t bytes = 0;
    std::byte first{};
  };

  TimedLine() {
    sockaddr_in at = hal::socket_address(0x7f000001, 0);
    socklen_t size = sizeof(at);
    const int on = 1;
    EXPECT_EQ(::setsockopt(robots_.get(), SOL_SOCKET, SO_TIMESTAMPNS, &on, sizeof on), 0);
    EXPECT_EQ(::bind(robots_.get(), reinterpret_cast<const sockaddr*>(&at), size), 0);
    EXPECT_EQ(::getsockname(robots_.get(), reinterpret_cast<sockaddr*>(&at), &size), 0);
    EXPECT_EQ(::connect(port_.get(), reinterpret_cast<const sockaddr*>(&at), size), 0);
    // The kernel begins to stamp some time later; until then it gives the time at which a packet is read.
    for (bool is_stamping = false; !is_stamping;) {
      EXPECT_EQ(::write(port_.get(), "", 1), 1);
      timespec sent{};
      ::clock_gettime(CLOCK_REALTIME, &sent);
      ::usleep(1000);
      is_stamping =
          arrivals().back().at_s <= static_cast<double>(sent.tv_sec) + 1e-9 * static_cast<double>(sent.tv_nsec);
    }
  }
  [[nodiscard]] int port() const { return port_.get(); }

  std::vector<Arrival> arrivals() {
    std::vector<Arrival> all;
    for (;;) {
      std::array<std::byte, 1024> bytes{};
      alignas(cmsghdr) std::array<char, 128> control{};
      iovec part{bytes.data(), bytes.size()};
      msghdr header{};
      header.msg_iov = &part;
      header.msg_iovlen = 1;
      header.msg_control = control.data();
      header.msg_controllen = control.size();
      const ssize_t size = ::recvmsg(robots_.get(), &header, MSG_DONTWAIT);
      if (size < 0) return all;
      const cmsghdr* const stamp = CMSG_FIRSTHDR(&header);
      EXPECT_TRUE(stamp != nullptr && stamp->cmsg_type == SO_TIMESTAMPNS);
      timespec time{};
      std::memcpy(&time, CMSG_DATA(stamp), sizeof time);
      all.push_back({static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec),
                     static_cast<std::size_t>(size), bytes[0]});
    }
  }

 private:
  hal::Descriptor robots_{::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)};
  hal::Descriptor port_{::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)};
};

Packet packet_of(std::size_t size, int value) {
  Packet packet;
  packet.resize(size);
  for (std::byte& byte : packet) byte = static_cast<std::byte>(value);
  return packet;
}

/// Three packets for the robots of each line. The program may have sent a packet immediately before the crash.
void crash_with(const TimedLine& line, const hal::LineTime& time, const TimedLine& other) {
  const Packet last = packet_of(50, 9);
  EXPECT_EQ(::write(line.port(), last.data(), last.size()), static_cast<ssize_t>(last.size()));
  in_another_process([&] {
    crash_stop::StopTargets targets;
    for (int robot = 0; robot < 3; ++robot) {
      targets.push_back({{.descriptor = line.port(), .line = time}, packet_of(50, robot)});
      targets.push_back({{.descriptor = other.port()}, packet_of(50, robot)});
    }
    crash_stop::prepare(targets);
    crash_stop::send_stop_packets();
  });
}

TEST(CrashStopPause, EachPacketHasThePauseOfItsLine) {
  TimedLine line, other;
  const hal::LineTime time{std::chrono::microseconds(80), std::chrono::milliseconds(10)};  // 4 ms for 50 bytes
  crash_with(line, time, other);
  const std::vector<TimedLine::Arrival> arrivals = line.arrivals(), unpaused = other.arrivals();
  ASSERT_EQ(arrivals.size(), 1U + 15U);
  for (std::size_t i = 1; i < arrivals.size(); ++i) {
    EXPECT_GE(arrivals[i].at_s - arrivals[i - 1].at_s, 0.014) << i;
    EXPECT_EQ(arrivals[i].first, static_cast<std::byte>((i - 1) % 3));
  }
  ASSERT_EQ(unpaused.size(), 15U);
  EXPECT_LT(unpaused[2].at_s, arrivals[1].at_s) << "a line without a pause waits for the other one";
}

TEST(CrashStopPause, LongPausesLeaveOnePacketForEachRobot) {
  TimedLine line, other;
  crash_with(line, {{}, std::chrono::milliseconds(350)}, other);
  const std::vector<TimedLine::Arrival> arrivals = line.arrivals();
  ASSERT_EQ(arrivals.size(), 1U + 3U);
  for (std::size_t i = 1; i < arrivals.size(); ++i) EXPECT_GE(arrivals[i].at_s - arrivals[i - 1].at_s, 0.35) << i;
}

TEST(CrashStopCapacity, HoldsTheLongestPacketsOfEachRobotAndRadio) {
  std::vector<std::unique_ptr<NetworkRobot>> robots;
  std::vector<GroupMember> radios;
  hal::MonotonicClock clock;
  for (std::size_t radio = 0; radio < hal::kMaxRadios; ++radio) {
    hal::UdpRadioSettings settings;
    for (hal::UdpEndpoint& endpoint : settings.robots) {
      robots.push_back(std::make_unique<NetworkRobot>());
      endpoint = {0x7f000001, static_cast<std::uint16_t>(std::stoi(robots.back()->port()))};
    }
    radios.push_back({std::make_unique<hal::UdpRadio>(settings), std::bitset<kMaxReceivers>().set()});
  }
  RadioGroup group(std::move(radios), clock, std::chrono::seconds(1), false);
  ASSERT_TRUE(group.open().ok());
  for (const bool is_for_all : {true, false}) {
    SCOPED_TRACE(is_for_all ? "a packet for all robots" : "a packet for each robot");
    OutgoingPackets stops;
    for (std::size_t robot = 0; robot < (is_for_all ? 1 : kMaxRobotsPerTeam); ++robot) {
      stops.push_back({packet_of(kMaxPacketBytes, static_cast<int>(robot)), is_for_all ? kAllRobots : robot});
    }
    in_another_process([&] {
      crash_stop::prepare(group, stops);
      crash_stop::send_stop_packets();
    });
    for (std::size_t i = 0; i < robots.size(); ++i) {
      const std::vector<std::byte> bytes = robots[i]->received_bytes();
      const auto value = static_cast<std::byte>(is_for_all ? 0 : i % kMaxRobotsPerTeam);
      EXPECT_EQ(bytes, std::vector<std::byte>(5 * kMaxPacketBytes, value)) << "robot " << i;
    }
  }
}

/// A radio with more routes than any board file gives.
class ManyRoutes final : public hal::Radio {
 public:
  explicit ManyRoutes(int descriptor) : descriptor_(descriptor) {}
  void add_routes(std::size_t /*receiver*/, hal::RadioRoutes& out) const override {
    for (std::size_t i = 0; i < out.capacity() + 1; ++i) out.push_back({.descriptor = descriptor_});
  }

 private:
  Result<void> do_open() override { return {}; }
  Result<void> do_send(const Packet& /*packet*/, std::size_t /*receiver*/) override { return {}; }
  Result<Duration> do_serve() override { return Duration::max(); }
  Result<std::size_t> do_receive(std::span<std::byte> /*into*/, std::size_t& /*sender*/) override {
    return std::size_t{0};
  }
  Result<void> do_drain(Instant /*deadline*/) override { return {}; }
  void do_close() override {}
  int descriptor_;
};

TEST(CrashStopCapacity, SendsTheFirstPacketsOfTooMany) {
  TimedLine line;
  OutgoingPackets stops;
  for (std::size_t robot = 0; robot < kMaxRobotsPerTeam; ++robot) stops.push_back({packet_of(20, 1), robot});
  in_another_process([&] {
    crash_stop::prepare(ManyRoutes(line.port()), stops);
    crash_stop::send_stop_packets();
  });
  const std::vector<TimedLine::Arrival> arrivals = line.arrivals();
  EXPECT_EQ(arrivals.size(), 5 * crash_stop::StopTargets::capacity());
  for (const TimedLine::Arrival& arrival : arrivals) EXPECT_EQ(arrival.bytes, 20U);
}

TEST(CrashStopAtExit, RobotsAreStoppedBeforeExit) {
  const Outcome outcome = run("exit");
  ASSERT_TRUE(WIFEXITED(outcome.status));
  EXPECT_EQ(WEXITSTATUS(outcome.status), 3);
  expect_stopped(outcome);
}

TEST(CrashStopAtExit, SendsNothingMoreAfterANormalEnd) {
  const Outcome outcome = run("none");
  ASSERT_TRUE(WIFEXITED(outcome.status));
  EXPECT_EQ(WEXITSTATUS(outcome.status), 0);
  ASSERT_EQ(outcome.packets.size(), 105U);
  for (std::size_t i = 1; i < outcome.packets.size(); ++i) {
    EXPECT_EQ(outcome.packets[i].stop, i >= 100);
    EXPECT_EQ(outcome.packets[i].sequence, static_cast<std::uint8_t>(outcome.packets[i - 1].sequence + 1));
  }
}

}  // namespace
}  // namespace touchline
