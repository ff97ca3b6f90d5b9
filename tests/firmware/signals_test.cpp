#include "firmware/signals.h"

#include <gtest/gtest.h>

#include <fcntl.h>
#include <unistd.h>
#include <csignal>
#include <cstdlib>
#include <thread>

#include "firmware/adaptation_requests.h"

namespace touchline {
namespace {

// Death tests use the threadsafe style, because the process has threads of drivers' libraries, and the thread sanitizer
// cannot follow a fork without exec.
class Signals : public ::testing::Test {
 protected:
  Signals() { GTEST_FLAG_SET(death_test_style, "threadsafe"); }
};
using StopSignal = Signals;
using ReloadSignal = Signals;
using AdaptationSignal = Signals;

// Runs in its own process, whose exit code says whether the flag was set.
[[noreturn]] void receive(int signal, int again, Duration pause) {
  const std::atomic<bool>& stop = handle_stop_signals();
  if (stop.load()) std::_Exit(2);
  static_cast<void>(std::raise(signal));
  std::this_thread::sleep_for(pause);
  static_cast<void>(std::raise(again));
  std::_Exit(stop.load() ? 0 : 1);
}

TEST_F(StopSignal, AnImmediateSecondSignalIsTheSameRequest) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    EXPECT_EXIT(receive(signal, signal, Duration{}), ::testing::ExitedWithCode(0), "");
  }
}

TEST_F(StopSignal, ASecondSignalLaterEndsTheProgram) {
  EXPECT_EXIT(receive(SIGTERM, SIGTERM, kForcedExitDelay + std::chrono::milliseconds(50)),
              ::testing::KilledBySignal(SIGTERM), "");
  EXPECT_EXIT(receive(SIGTERM, SIGINT, kForcedExitDelay + std::chrono::milliseconds(50)),
              ::testing::KilledBySignal(SIGINT), "");
}

TEST_F(StopSignal, ABrokenPipeDoesNotEndTheProgram) {
  EXPECT_EXIT(receive(SIGTERM, SIGPIPE, kForcedExitDelay + std::chrono::milliseconds(50)), ::testing::ExitedWithCode(0),
              "");
}

[[noreturn]] void steer() {
  const AdaptationRequests& requests = handle_adaptation_signals();
  static_cast<void>(std::raise(SIGUSR1));
  const bool frozen = requests.freeze == 1 && requests.reset == 0;
  static_cast<void>(std::raise(SIGUSR2));
  std::_Exit(frozen && requests.freeze == 1 && requests.reset == 1 ? 0 : 1);
}

[[noreturn]] void hang_up(bool ignored) {
  if (ignored) std::signal(SIGHUP, SIG_IGN);
  const std::atomic<bool>& stop = handle_stop_signals();
  const std::atomic<std::uint32_t>& requests = handle_reload_signal();
  static_cast<void>(std::raise(SIGHUP));
  std::_Exit(stop.load() ? 3 : static_cast<int>(requests.load()));
}

/// Runs in its own session with a terminal that is closed before the second signal.
[[noreturn]] void lose_terminal(bool ignored) {
  const int master = ::posix_openpt(O_RDWR | O_NOCTTY);
  if (master < 0 || ::grantpt(master) != 0 || ::unlockpt(master) != 0) std::_Exit(90);
  if (::setsid() < 0) std::_Exit(91);
  if (::open(::ptsname(master), O_RDWR) < 0) std::_Exit(92);  // becomes the session's terminal
  std::signal(SIGHUP, ignored ? SIG_IGN : SIG_DFL);
  const std::atomic<bool>& stop = handle_stop_signals();
  const std::atomic<std::uint32_t>& requests = handle_reload_signal();
  static_cast<void>(std::raise(SIGHUP));
  if (stop.load() || requests.load() != 1) std::_Exit(93);  // the terminal is open: SIGHUP requests a reload
  ::close(master);
  while (!stop.load() && requests.load() < 2) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  std::_Exit(stop.load() ? 3 : 2);
}

TEST_F(ReloadSignal, CountsUnlessTheTerminalIsClosed) {
  EXPECT_EXIT(hang_up(false), ::testing::ExitedWithCode(1), "");
  EXPECT_EXIT(hang_up(true), ::testing::ExitedWithCode(1), "");
  EXPECT_EXIT(lose_terminal(false), ::testing::ExitedWithCode(3), "");
  EXPECT_EXIT(lose_terminal(true), ::testing::ExitedWithCode(2), "") << "with nohup it continues";
}

TEST_F(AdaptationSignal, EachSignalCountsItsRequests) { EXPECT_EXIT(steer(), ::testing::ExitedWithCode(0), ""); }

}  // namespace
}  // namespace touchline
