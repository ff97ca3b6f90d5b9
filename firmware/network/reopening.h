#pragma once

#include <algorithm>
#include <functional>
#include <string>
#include <utility>

#include "core/time.h"
#include "hal/result.h"

namespace touchline::network {

/// Prints a line for a person; the line is given without its line end.
using Print = std::function<void(const std::string& line)>;

/// Decides when a failed output or input is opened again: after a pause that doubles with each failure. Reports a
/// failure once, and the recovery once.
class Reopening {
 public:
  explicit Reopening(std::string name) : name_(std::move(name)) {}

  [[nodiscard]] bool is_due(Instant now) const { return now >= next_attempt_; }
  void on_failure(const Error& error, Instant now, const Print& print) {
    next_attempt_ = now + pause_;
    pause_ = std::min(2 * pause_, kLongestPause);
    if (std::exchange(failed_, true)) return;
    print("network: " + name_ + ": " + error.text.str() + "; trying again");
  }
  void on_success(const Print& print) {
    pause_ = kFirstPause;
    if (std::exchange(failed_, false)) print("network: " + name_ + ": works again");
  }

 private:
  // Pause after the first failure. A program that restarts is back at once; a cable that was pulled out takes seconds.
  static constexpr Duration kFirstPause = std::chrono::milliseconds(100);
  static constexpr Duration kLongestPause = std::chrono::seconds(2);

  const std::string name_;
  bool failed_ = false;
  Duration pause_ = kFirstPause;
  Instant next_attempt_{};
};

}  // namespace touchline::network
