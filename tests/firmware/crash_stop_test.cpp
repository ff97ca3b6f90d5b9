// However the process ends, the last packets that the robots receive are stop packets.
#include "firmware/crash_stop.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>
#include <csignal>
#include <cstdlib>
#include <string>
#include <vector>

#include <gtest/gtest.h>

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
Outcome run(const std::string& ending) {
  Outcome outcome;
  const int robots = ::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
  EXPECT_TRUE(robots >= 0 && ::grantpt(robots) == 0 && ::unlockpt(robots) == 0);
  const std::string device = ::ptsname(robots);
  const pid_t child = ::fork();
  if (child == 0) {
    ::execl(TOUCHLINE_CRASH_PROGRAM, TOUCHLINE_CRASH_PROGRAM, device.c_str(), ending.c_str(), nullptr);
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
