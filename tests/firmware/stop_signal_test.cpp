#include "firmware/stop_signal.h"

#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>
#include <thread>

namespace touchline {
namespace {

// Signals reach a process of their own; its exit code tells whether the flag was set.
[[noreturn]] void receive(int signal, int again, Duration pause) {
  const std::atomic<bool>& stop = stop_on_signals();
  if (stop.load()) std::_Exit(2);
  static_cast<void>(std::raise(signal));
  std::this_thread::sleep_for(pause);
  static_cast<void>(std::raise(again));
  std::_Exit(stop.load() ? 0 : 1);
}

TEST(StopSignal, ASecondSignalAtOnceIsTheSameRequest) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    EXPECT_EXIT(receive(signal, signal, Duration{}), ::testing::ExitedWithCode(0), "");
  }
}

TEST(StopSignal, ASecondSignalLaterEndsTheProgram) {
  EXPECT_EXIT(receive(SIGTERM, SIGTERM, kInsistence + std::chrono::milliseconds(50)),
              ::testing::KilledBySignal(SIGTERM), "");
  EXPECT_EXIT(receive(SIGTERM, SIGINT, kInsistence + std::chrono::milliseconds(50)), ::testing::KilledBySignal(SIGINT),
              "");
}

TEST(StopSignal, APipeWithoutReaderEndsNothing) {
  EXPECT_EXIT(receive(SIGTERM, SIGPIPE, kInsistence + std::chrono::milliseconds(50)), ::testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace touchline
