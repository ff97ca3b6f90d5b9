#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <thread>

#include "core/time.h"
#include "hal/result.h"

namespace touchline {

/// Reopens one lost device on its own thread, after pauses that double, so that the loop never waits for a driver.
/// While the device is lost, only that thread may touch it.
class DeviceReconnector {
 public:
  /// Closes the device if necessary, then opens and starts it. May block, allocate and throw.
  using Reopen = Result<void> (*)(void* device);
  static constexpr Duration kLongestPause = std::chrono::seconds(8);
  // While the device is absent, an attempt is cheap, and a person may be about to plug it in.
  static constexpr Duration kLongestPauseAbsent = std::chrono::seconds(2);

  /// `wait_for_driver`: poll() waits for the result of an attempt. Runs in simulated time are then repeatable, because
  /// this time does not advance during the attempt.
  DeviceReconnector(Reopen reopen, void* device, Duration first_pause, bool wait_for_driver);
  ~DeviceReconnector();
  DeviceReconnector(const DeviceReconnector&) = delete;
  DeviceReconnector& operator=(const DeviceReconnector&) = delete;

  [[nodiscard]] bool is_open() const { return is_open_; }
  /// Applies to the next loss.
  void set_first_pause(Duration pause) { first_pause_ = pause; }
  /// Marks the device as lost. No effect if it is already lost.
  void mark_lost(Instant now);
  /// Call it in each iteration. Starts the attempts that are due; returns the result of one that has ended since the
  /// last call. After success the device is open.
  std::optional<Result<void>> poll(Instant now);
  /// Time since the device was lost; zero if it is open.
  [[nodiscard]] Duration time_lost(Instant now) const { return is_open_ ? Duration::zero() : now - lost_at_; }
  /// Waits for an attempt in progress and starts no others.
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
  std::atomic<Task> task_{Task::kIdle};
  Result<void> result_;  // written by the thread, published by task_
  std::thread thread_;
};

}  // namespace touchline
