#include "firmware/service_notifier.h"

#include <systemd/sd-daemon.h>
#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>

namespace touchline {
namespace {

using Microseconds = std::chrono::duration<std::uint64_t, std::micro>;

// Longest period of notifications. It is short, because tools/deploy waits for the first frame.
constexpr Microseconds kLongestNotifyPeriod = std::chrono::milliseconds(50);
// Pings sent per watchdog time; three may be late before the watchdog acts.
constexpr std::uint64_t kPingsPerWatchdogTime = 4;

/// Returns the file that shows that good frames have arrived; "": none.
std::string frames_file() {
  const char* const folder = std::getenv("RUNTIME_DIRECTORY");
  return folder != nullptr ? std::string(folder) + "/frames" : std::string();
}

}  // namespace

ServiceNotifier::ServiceNotifier(const LoopHeartbeat& heartbeat)
    : heartbeat_(&heartbeat), enabled_(std::getenv("NOTIFY_SOCKET") != nullptr) {
  if (enabled_) thread_ = std::thread([this] { work(); });  // work() calls nothing that throws
}

void ServiceNotifier::end() {
  if (!thread_.joinable()) return;
  end_.store(true, std::memory_order_release);
  thread_.join();
  static_cast<void>(sd_notify(0, "STOPPING=1"));
}

void ServiceNotifier::status(const std::string& line) const {
  if (is_enabled()) static_cast<void>(sd_notify(0, ("STATUS=" + line).c_str()));
}

LoopEnd run(Loop& loop, ServiceNotifier& service, const std::atomic<bool>& stop) {
  const LoopEnd end = loop.run(stop);
  if (end == LoopEnd::kRestart) {
    service.watch(nullptr);
  } else {
    service.end();
  }
  return end;
}

void ServiceNotifier::watch(const LoopHeartbeat* heartbeat) {
  const std::scoped_lock lock(mutex_);
  heartbeat_ = heartbeat;
}

void ServiceNotifier::work() {
  std::uint64_t watchdog_us = 0;
  const bool is_watched = sd_watchdog_enabled(0, &watchdog_us) > 0;
  const Microseconds period = is_watched
                                  ? std::min(kLongestNotifyPeriod, Microseconds(watchdog_us / kPingsPerWatchdogTime))
                                  : kLongestNotifyPeriod;
  const std::string frames = frames_file();
  bool is_ready = false, is_marked = frames.empty();
  std::error_code ignored;
  std::filesystem::remove(frames, ignored);
  std::uint64_t iterations = 0;
  auto started = std::chrono::steady_clock::now();
  while (!end_.load(std::memory_order_acquire)) {
    const std::chrono::steady_clock::time_point now = std::chrono::steady_clock::now();
    bool has_frame = false, is_alive = now - started < kLongestStart;
    {
      const std::scoped_lock lock(mutex_);
      if (heartbeat_ != nullptr) {
        started = now;
        has_frame = heartbeat_->good_frames.load(std::memory_order_relaxed) > 0;
        const std::uint64_t iterations_now = heartbeat_->iterations.load(std::memory_order_relaxed);
        is_alive = std::exchange(iterations, iterations_now) != iterations_now;
      }
    }
    if (has_frame && !std::exchange(is_marked, true)) std::ofstream{frames};
    const bool has_started = has_frame || is_page_ready_.load(std::memory_order_acquire);
    if (has_started && !std::exchange(is_ready, true)) static_cast<void>(sd_notify(0, "READY=1"));
    if (is_watched && is_alive) static_cast<void>(sd_notify(0, "WATCHDOG=1"));
    std::this_thread::sleep_for(period);
  }
}

}  // namespace touchline
