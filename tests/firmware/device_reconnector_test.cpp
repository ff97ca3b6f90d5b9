#include "firmware/device_reconnector.h"

#include <new>
#include <semaphore>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace touchline {
namespace {

using namespace std::chrono_literals;

Instant instant(double s) { return Instant(from_seconds(s)); }

struct Scripted {
  int failures = 0, calls = 0;
  ErrorCode failure = ErrorCode::kNotFound;
  static Result<void> reopen(void* self) {
    Scripted& script = *static_cast<Scripted*>(self);
    if (++script.calls > script.failures) return {};
    return Error{script.failure, "scripted fault"};
  }
};

TEST(ThreadsDeviceReconnector, PausesDoubleAfterEachFailure) {
  Scripted script{3};
  DeviceReconnector reconnector(Scripted::reopen, &script, 100ms, true);
  std::vector<ErrorCode> results;
  const auto poll = [&](double time) {
    if (const auto result = reconnector.poll(instant(time))) results.push_back(result->code());
    return reconnector.is_open();
  };
  EXPECT_TRUE(reconnector.is_open());
  EXPECT_TRUE(poll(5.0));
  EXPECT_EQ(script.calls, 0);
  reconnector.mark_lost(instant(10.0));
  reconnector.mark_lost(instant(10.05));  // ignored: it is already lost
  EXPECT_FALSE(reconnector.is_open());
  for (const auto& [time, calls] : {std::pair{10.09, 0}, {10.1, 1}, {10.29, 1}, {10.3, 2}, {10.69, 2}, {10.7, 3}}) {
    EXPECT_FALSE(poll(time));
    EXPECT_EQ(script.calls, calls) << time;
  }
  EXPECT_EQ(results, std::vector<ErrorCode>(3, ErrorCode::kNotFound));
  EXPECT_EQ(reconnector.time_lost(instant(11.0)), 1s);
  EXPECT_FALSE(poll(11.49));
  EXPECT_TRUE(poll(11.5));
  EXPECT_EQ(results.size(), 4U);
  EXPECT_EQ(results.back(), ErrorCode::kOk);
  EXPECT_EQ(reconnector.time_lost(instant(12.0)), 0s);
  // After the next loss, the pauses start again with the first one.
  script.failures = 100;
  reconnector.mark_lost(instant(20.0));
  EXPECT_FALSE(poll(20.1));
  EXPECT_EQ(script.calls, 5);
}

TEST(ThreadsDeviceReconnector, AnAbsentDeviceHasShorterPauses) {
  for (const auto& [failure, pause] : {std::pair{ErrorCode::kNotFound, DeviceReconnector::kLongestPauseAbsent},
                                       std::pair{ErrorCode::kIo, DeviceReconnector::kLongestPause}}) {
    Scripted script{1000, 0, failure};
    DeviceReconnector reconnector(Scripted::reopen, &script, 100ms, true);
    reconnector.mark_lost(instant(0.0));
    Instant now = instant(0.0), last = now;
    Duration longest{};
    for (int calls = 0; now < instant(60.0); now += 10ms) {
      static_cast<void>(reconnector.poll(now));
      if (script.calls == calls) continue;
      calls = script.calls;
      longest = std::max(longest, now - std::exchange(last, now));
    }
    EXPECT_EQ(longest, pause) << describe(failure);
  }
}

struct Throwing {
  static Result<void> reopen(void*) { throw std::bad_alloc(); }
};

TEST(ThreadsDeviceReconnector, AnExceptionOfADriverIsAFailure) {
  DeviceReconnector reconnector(Throwing::reopen, nullptr, 100ms, true);
  reconnector.mark_lost(instant(1.0));
  const std::optional<Result<void>> result = reconnector.poll(instant(2.0));
  ASSERT_TRUE(result.has_value());
  EXPECT_EQ(result->code(), ErrorCode::kIo);
  EXPECT_FALSE(reconnector.is_open());
}

struct Hanging {
  std::binary_semaphore entered{0}, answer{0};
  static Result<void> reopen(void* self) {
    Hanging& driver = *static_cast<Hanging*>(self);
    driver.entered.release();
    driver.answer.acquire();
    return {};
  }
};

TEST(ThreadsDeviceReconnector, AHangingDriverDoesNotBlockTheCaller) {
  Hanging driver;
  DeviceReconnector reconnector(Hanging::reopen, &driver, 1ms, false);
  reconnector.mark_lost(instant(1.0));
  EXPECT_FALSE(reconnector.poll(instant(2.0)));
  driver.entered.acquire();
  for (int i = 0; i < 1000; ++i) EXPECT_FALSE(reconnector.poll(instant(3.0 + i)));
  driver.answer.release();
  // The result comes from another thread, after some time.
  bool back = false;
  for (int i = 0; i < 5000 && !back; ++i) {
    back = reconnector.poll(instant(2000.0)).has_value();
    if (!back) std::this_thread::sleep_for(1ms);
  }
  EXPECT_TRUE(back);
  EXPECT_TRUE(reconnector.is_open());
}

TEST(ThreadsDeviceReconnector, CanBeDestroyedDuringAnAttempt) {
  Hanging driver;
  auto reconnector = std::make_unique<DeviceReconnector>(Hanging::reopen, &driver, 1ms, false);
  reconnector->mark_lost(instant(1.0));
  EXPECT_FALSE(reconnector->poll(instant(2.0)));
  driver.entered.acquire();
  std::thread late([&] { driver.answer.release(); });
  reconnector.reset();
  late.join();
}

}  // namespace
}  // namespace touchline
