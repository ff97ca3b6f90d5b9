#pragma once

#include <atomic>
#include <string>
#include <thread>

#include "firmware/loop.h"

namespace touchline {

/// Tells systemd how it goes (sd_notify): READY=1 after the first good frame, WATCHDOG=1 while the loop turns and no
/// longer, STATUS= as a person would read it, STOPPING=1 at the end. On a thread of its own: output that hangs must not
/// look like a loop that hangs, and the loop calls nothing. When nobody asked to be told (no $NOTIFY_SOCKET), nothing
/// is done.
class ServiceNotifier {
 public:
  /// `heartbeat` must outlive the watch.
  explicit ServiceNotifier(const LoopHeartbeat& heartbeat);
  ~ServiceNotifier() { end(); }
  ServiceNotifier(const ServiceNotifier&) = delete;
  ServiceNotifier& operator=(const ServiceNotifier&) = delete;

  /// Whether a service manager listens.
  [[nodiscard]] bool is_enabled() const { return enabled_; }
  /// One line, without its end. From any thread but the loop's: it may block.
  void status(const std::string& line) const;
  /// Tells the end, once: the watchdog wants nothing more.
  void end();

 private:
  void work();

  const LoopHeartbeat& heartbeat_;
  const bool enabled_;
  std::atomic<bool> end_{false};
  std::thread thread_;
};

/// Loop::run(), and tells the end before anything else is waited for: a loop that turns no more is no work for a
/// watchdog, but the camera may be just being set or opened, and both may take long. Robots have been stopped by then.
LoopEnd run(Loop& loop, ServiceNotifier& service, const std::atomic<bool>& stop);

}  // namespace touchline
