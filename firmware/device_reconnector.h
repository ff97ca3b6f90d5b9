#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <thread>

#include "core/time.h"
#include "hal/result.h"

namespace touchline {

/// Reopens one lost device on a separate thread, so that the loop never waits for a driver. The pauses between the
/// attempts double. While the device is lost, only the separate thread may touch it.
class DeviceReconnector {
 public:
  /// Closes the device if necessary, then opens and starts it. May block, allocate and throw.
  using Reopen = Result<void> (*)(void* device);
  static constexpr Duration kLongestPause = std::chrono::seconds(8);
  // Longest pause while the device is absent. It is short, because such an attempt is cheap and a person may be about
  // to plug the device in.
  static constexpr Duration kLongestPauseAbsent = std::chrono::seconds(2);

  /// `wait_for_driver`: poll() waits for the result of an attempt. This makes runs in simulated time repeatable,
  /// because simulated time does not advance during the attempt.
  DeviceReconnector(Reopen reopen, void* device, Duration first_pause, bool wait_for_driver);
  ~DeviceReconnector();
  DeviceReconnector(const DeviceReconnector&) = delete;
  DeviceReconnector& operator=(const DeviceReconnector&) = delete;

  [[nodiscard]] bool is_open() const { return is_open_; }
  /// Sets the pause before the first attempt after the next loss.
  void set_first_pause(Duration pause) { first_pause_ = pause; }
  /// Marks the device as lost. No effect if it is already lost. `former_pause`: last pause of a former reconnector
  /// whose success did not last, so that the pauses go on growing; zero: they start with the first one.
  void mark_lost(Instant now, Duration former_pause = {});
  /// Call it in each iteration. Starts the attempts that are due, and returns the result of an attempt that has ended
  /// since the last call. After success the device is open.
  std::optional<Result<void>> poll(Instant now);
  /// Returns the time since the device was lost; zero if it is open.
  [[nodiscard]] Duration time_lost(Instant now) const { return is_open_ ? Duration::zero() : now - lost_at_; }
  /// Returns the pause before the last or next attempt since the last loss; zero if there was no loss.
  [[nodiscard]] Duration pause() const { return pause_; }
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
