#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "firmware/report_printer.h"
#include "firmware/session.h"

namespace touchline {

/// Passes a session that was loaded on another thread to the loop's thread, which ends the current session in favor of
/// it.
class SessionSwitch {
 public:
  /// The loading thread offers a session. It replaces an offered session that was not taken.
  void offer(std::unique_ptr<Session> next) {
    const std::scoped_lock lock(mutex_);
    next_ = std::move(next);
    is_waiting_.store(true, std::memory_order_release);
  }
  /// Returns the flag for LoopSettings::restart.
  [[nodiscard]] const std::atomic<bool>& is_waiting() const { return is_waiting_; }
  /// Returns the offered session; call it after the loop has ended.
  std::unique_ptr<Session> take() {
    const std::scoped_lock lock(mutex_);
    is_waiting_.store(false, std::memory_order_relaxed);
    return std::move(next_);
  }

 private:
  std::mutex mutex_;
  std::unique_ptr<Session> next_;
  std::atomic<bool> is_waiting_{false};
};

/// Prints the lines of threads that live longer than the printer of a session. Between two sessions, lines wait for the
/// next printer, because the console's thread must not wait for a terminal.
class LinePrinter {
 public:
  /// Sets the printer; null: there is none at the moment.
  void set(ReportPrinter* printer) {
    const std::scoped_lock lock(mutex_);
    printer_ = printer;
    if (printer_ == nullptr) return;
    for (const std::string& line : std::exchange(waiting_, {})) printer_->print_line(line);
  }
  void print(const std::string& line) {
    const std::scoped_lock lock(mutex_);
    if (printer_ != nullptr) {
      printer_->print_line(line);
    } else if (waiting_.size() < kMaxWaiting) {
      waiting_.push_back(line);
    }
  }

 private:
  std::mutex mutex_;
  ReportPrinter* printer_ = nullptr;
  std::vector<std::string> waiting_;
  // Enough for lines about clients that connect and leave while devices are opened.
  static constexpr std::size_t kMaxWaiting = 100;
};

}  // namespace touchline
