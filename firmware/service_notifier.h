#pragma once

#include <atomic>
#include <chrono>
#include <mutex>
#include <string>
#include <thread>

#include "firmware/loop.h"

namespace touchline {

/// Notifies systemd (sd_notify): READY=1 after the first good frame or when the page answers, WATCHDOG=1 only while the
/// loop iterates, STATUS= as text, STOPPING=1 at the end. The file `frames` in $RUNTIME_DIRECTORY shows that good
/// frames have arrived. It has its own thread, so that blocked output does not look like a hanging loop and the loop
/// makes no system calls for it. Does nothing without a service manager ($NOTIFY_SOCKET).
class ServiceNotifier {
 public:
  /// `heartbeat` must outlive the notifier, or the next call of watch().
  explicit ServiceNotifier(const LoopHeartbeat& heartbeat);
  ~ServiceNotifier() { end(); }
  ServiceNotifier(const ServiceNotifier&) = delete;
  ServiceNotifier& operator=(const ServiceNotifier&) = delete;

  /// Returns whether there is a service manager to notify.
  [[nodiscard]] bool is_enabled() const { return enabled_; }
  /// Call it when the console's page answers. The service then counts as started, whatever the devices do.
  void set_ready() { is_page_ready_.store(true, std::memory_order_release); }
  /// Sends one line; `line` has no line end. Any thread except the loop's may call it, because it may block.
  void status(const std::string& line) const;
  /// Watches another loop from now on; null: one is being started, which may take kLongestStart.
  void watch(const LoopHeartbeat* heartbeat);
  /// Sends STOPPING=1, once, which ends the watchdog.
  void end();

 private:
  void work();

  // Longest time for opening a camera and setting its controls.
  static constexpr std::chrono::seconds kLongestStart{15};

  std::mutex mutex_;
  const LoopHeartbeat* heartbeat_;
  const bool enabled_;
  std::atomic<bool> end_{false}, is_page_ready_{false};
  std::thread thread_;
};

/// Calls Loop::run(), then ServiceNotifier::end() unless another loop follows (LoopEnd::kRestart). The program may then
/// still wait for a camera that is being configured or opened, which the watchdog must not mistake for a hanging loop.
/// The robots have already been stopped.
LoopEnd run(Loop& loop, ServiceNotifier& service, const std::atomic<bool>& stop);

}  // namespace touchline
