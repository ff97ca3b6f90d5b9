#pragma once

#include <atomic>
#include <optional>
#include <string>
#include <thread>

#include "firmware/loop_pulse.h"

namespace touchline {

class Loop;

/// Tells systemd how it goes (sd_notify): READY=1 after the first good frame, WATCHDOG=1 while the loop turns and no
/// longer, STATUS= as a person would read it, STOPPING=1 at the end. On a thread of its own: output that hangs must not
/// look like a loop that hangs, and the loop calls nothing. When nobody asked to be told (no $NOTIFY_SOCKET), nothing
/// is done.
class ServiceWatch {
 public:
  /// `pulse` must outlive the watch.
  explicit ServiceWatch(const LoopPulse& pulse);
  ~ServiceWatch();
  ServiceWatch(const ServiceWatch&) = delete;
  ServiceWatch& operator=(const ServiceWatch&) = delete;

  /// Whether a service manager listens.
  [[nodiscard]] bool is_asked() const { return thread_.joinable(); }
  /// One line, without its end. From any thread but the loop's: it may block.
  void status(const std::string& line) const;

 private:
  void work();

  const LoopPulse& pulse_;
  std::atomic<bool> end_{false};
  std::thread thread_;
};

/// Tells the end, then closes the loop's devices: that waits for one that is just being opened, and a loop that turns
/// no more is no work for a watchdog.
void leave(std::optional<ServiceWatch>& service, Loop& loop);

}  // namespace touchline
