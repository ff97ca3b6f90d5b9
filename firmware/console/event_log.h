#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace touchline::console {

/// A line of the log, which the terminal also shows.
struct Event {
  std::uint64_t number = 0;  // number of the event, counted from 1
  double time_s = 0.0;       // Unix time
  std::string_view level;    // "info", "warning" or "error"; points to a literal
  std::string text;
};

/// The last lines of the log, for clients that connect later. Any thread except the loop's may use it, because it
/// locks.
class EventLog {
 public:
  void add(std::string_view level, std::string text) {
    const double time_s = std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
    const std::scoped_lock lock(mutex_);
    events_.push_back({++last_, time_s, level, std::move(text)});
    if (events_.size() > kMaxEvents) events_.pop_front();
  }
  /// Returns the oldest event after `number` that is still kept.
  [[nodiscard]] std::optional<Event> after(std::uint64_t number) const {
    const std::scoped_lock lock(mutex_);
    for (const Event& event : events_) {
      if (event.number > number) return event;
    }
    return std::nullopt;
  }

  /// Returns all kept events, oldest first.
  [[nodiscard]] std::vector<Event> all() const {
    const std::scoped_lock lock(mutex_);
    return {events_.begin(), events_.end()};
  }

 private:
  // Number of lines that are kept: one or two screens.
  static constexpr std::size_t kMaxEvents = 100;

  mutable std::mutex mutex_;
  std::deque<Event> events_;
  std::uint64_t last_ = 0;
};

}  // namespace touchline::console
