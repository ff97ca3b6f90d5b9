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
class ServiceWatch {
 public:
  /// `pulse` must outlive the watch.
  explicit ServiceWatch(const LoopPulse& pulse);
  ~ServiceWatch() { end(); }
  ServiceWatch(const ServiceWatch&) = delete;
  ServiceWatch& operator=(const ServiceWatch&) = delete;

  /// Whether a service manager listens.
  [[nodiscard]] bool is_asked() const { return asked_; }
  /// One line, without its end. From any thread but the loop's: it may block.
  void status(const std::string& line) const;
  /// Tells the end, once: the watchdog wants nothing more.
  void end();

 private:
  void work();

  const LoopPulse& pulse_;
  const bool asked_;
  std::atomic<bool> end_{false};
  std::thread thread_;
};

/// Loop::run(), and tells the end before anything else is waited for: a loop that turns no more is no work for a
/// watchdog, but the camera may be just being set or opened, and both may take long. Robots have been stopped by then.
LoopEnd run(Loop& loop, ServiceWatch& service, const std::atomic<bool>& stop);

}  // namespace touchline
