#include "firmware/stop_signal.h"

#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>
#include <thread>

#include "firmware/adaptation_signal.h"

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

[[noreturn]] void steer() {
  const AdaptationRequests& requests = adaptation_on_signals();
  static_cast<void>(std::raise(SIGUSR1));
  const bool frozen = requests.freeze == 1 && requests.put_back == 0;
  static_cast<void>(std::raise(SIGUSR2));
  std::_Exit(frozen && requests.freeze == 1 && requests.put_back == 1 ? 0 : 1);
}

TEST(AdaptationSignal, EachCountsWhatItAsksFor) { EXPECT_EXIT(steer(), ::testing::ExitedWithCode(0), ""); }

}  // namespace
}  // namespace touchline
