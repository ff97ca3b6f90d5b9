#include "firmware/device_reconnector.h"

#include <algorithm>
#include <utility>

namespace touchline {

DeviceReconnector::DeviceReconnector(Reopen reopen, void* device, Duration first_pause, bool wait_for_driver)
    : reopen_(reopen), device_(device), first_pause_(first_pause), wait_for_driver_(wait_for_driver) {
  thread_ = std::thread([this] { work(); });
}

DeviceReconnector::~DeviceReconnector() { stop(); }

void DeviceReconnector::work() {
  while (true) {
    task_.wait(Task::kIdle);
    Task task = task_.load(std::memory_order_acquire);
    if (task == Task::kEnd) return;
    if (task == Task::kDone) {
      task_.wait(Task::kDone);
      continue;
    }
    if (task != Task::kOpen) continue;
    try {
      result_ = reopen_(device_);
    } catch (...) {  // out of memory, or a failure in a driver's library: another attempt may succeed
      result_ = failure(ErrorCode::kIo, "the driver threw an exception");
    }
    // The exchange fails if stop() was called meanwhile.
    if (!task_.compare_exchange_strong(task, Task::kDone, std::memory_order_acq_rel)) return;
    task_.notify_all();
  }
}

void DeviceReconnector::mark_lost(Instant now, Duration former_pause) {
  if (!is_open_) return;
  is_open_ = false;
  lost_at_ = now;
  pause_ = std::max(first_pause_, std::min<Duration>(2 * former_pause, kLongestPause));
  next_attempt_ = now + pause_;
}

std::optional<Result<void>> DeviceReconnector::poll(Instant now) {
  if (is_open_) return std::nullopt;
  Task task = task_.load(std::memory_order_acquire);
  if (task == Task::kIdle) {
    if (now < next_attempt_) return std::nullopt;
    task_.store(Task::kOpen, std::memory_order_release);
    task_.notify_all();
    task = Task::kOpen;
  }
  if (task == Task::kOpen && wait_for_driver_) {
    task_.wait(Task::kOpen);
    task = task_.load(std::memory_order_acquire);
  }
  if (task != Task::kDone) return std::nullopt;
  Result<void> result = std::move(result_);
  task_.store(Task::kIdle, std::memory_order_release);
  task_.notify_all();
  is_open_ = result.ok();
  if (!is_open_) {
    const bool is_absent = result.code() == ErrorCode::kNotFound;
    pause_ = std::min(2 * pause_, is_absent ? std::max(kLongestPauseAbsent, first_pause_) : kLongestPause);
    next_attempt_ = now + pause_;
  }
  return result;
}

void DeviceReconnector::stop() {
  if (!thread_.joinable()) return;
  task_.store(Task::kEnd, std::memory_order_release);
  task_.notify_all();
  thread_.join();
}

}  // namespace touchline
