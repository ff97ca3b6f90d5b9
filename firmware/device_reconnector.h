#pragma once

#include <atomic>
#include <cstdint>
#include <thread>

#include "core/status.h"
#include "core/time.h"
#include "hal/clock.h"

namespace touchline {

/// Keeps one device open: when it is lost, opens it again on a thread of its own, after pauses that double, so that the
/// loop never waits for a driver. While the device is not open, nobody but that thread may touch it.
class DeviceReconnector {
 public:
  /// Closes what is left, opens and starts the device; may block and allocate.
  using Reopen = Status (*)(void* device);
  static constexpr Duration kLongestPause = std::chrono::seconds(8);
  // While it is not there at all, when asking costs little and somebody may be about to plug it in.
  static constexpr Duration kLongestPauseAbsent = std::chrono::seconds(2);

  /// With `wait_for_driver` poll() waits until the driver has answered: in simulated time, which does not pass while a
  /// driver works, this makes a run repeatable.
  DeviceReconnector(Reopen reopen, void* device, Duration first_pause, bool wait_for_driver);
  ~DeviceReconnector();
  DeviceReconnector(const DeviceReconnector&) = delete;
  DeviceReconnector& operator=(const DeviceReconnector&) = delete;

  [[nodiscard]] bool is_open() const { return is_open_; }
  /// From the next loss on.
  void set_first_pause(Duration pause) { first_pause_ = pause; }
  /// The device is lost from now on.
  void mark_lost(Instant now);
  /// To be called in each iteration. True when the device has just come back.
  bool poll(Instant now);
  /// How long it has been away.
  [[nodiscard]] Duration time_lost(Instant now) const { return is_open_ ? Duration::zero() : now - lost_at_; }
  /// Of the last attempt.
  [[nodiscard]] Status last_status() const { return last_status_; }
  /// One more than before after each attempt that failed.
  [[nodiscard]] std::uint32_t failed_attempts() const { return failed_attempts_; }
  /// Waits for an attempt that is under way; from then on there are none.
  void stop();

 private:
  enum class Task : std::uint8_t { kIdle, kOpen, kDone, kEnd };
  void work();

  Reopen reopen_;
  void* device_;
  Duration first_pause_;
  const bool wait_for_driver_;
  bool is_open_ = true;
  Instant lost_at_{}, next_attempt_{};
  Duration pause_{};
  Status last_status_;
  std::uint32_t failed_attempts_ = 0;
  std::atomic<Task> task_{Task::kIdle};
  Status result_;  // the worker's, published by task_
  std::thread worker_;
};

}  // namespace touchline
