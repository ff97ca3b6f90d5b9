#pragma once

#include <atomic>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

#include "firmware/loop_report.h"
#include "firmware/service_notifier.h"
#include "firmware/status_text.h"
#include "hal/files/text_output.h"

namespace touchline {

struct ReportPrinterSettings {
  Expectation expected;
  bool status_lines = true;                  // false: only faults, halts and low batteries
  int map_columns = 0;                       // width of the field map; 0: none
  bool map_colors = false;                   // as hal::shows_color() says
  const ServiceNotifier* service = nullptr;  // also gets the status; null: none
  std::function<std::string()> network;      // end of the status line; called on the printer's thread
  // Gets every line but the status, with its level (info, warning or error), on the printer's thread. Empty if it is
  // not called.
  std::function<void(const char* level, const std::string& line)> on_event;
  std::function<void(const StatusReport&)> on_status;  // gets each status
  std::function<void(const HaltReport&)> on_halt;      // gets each halt that has begun, changed or ended
};

/// Takes the loop's reports from the ring on its own thread and prints them: the status to standard output, events to
/// standard error. Never waits for the terminal, so service manager and console get every report, and nothing delays
/// the end of the program.
class ReportPrinter {
 public:
  ReportPrinter(ReportRing& ring, const ReportPrinterSettings& settings, hal::TextOutput& output);
  /// Prints the remaining reports.
  ~ReportPrinter();
  /// Prints a line, given without its end, to standard error. Any thread except the loop's may call it, because it
  /// locks.
  void print_line(const std::string& line);
  ReportPrinter(const ReportPrinter&) = delete;
  ReportPrinter& operator=(const ReportPrinter&) = delete;

 private:
  void work();
  void print_all();
  void print_waiting();
  void print(const Report& report);
  void print_event(const char* level, const std::string& line);
  [[nodiscard]] std::string line_of(const StatusReport& status) const;
  void print_map(const StatusReport& status);

  ReportRing& ring_;
  const ReportPrinterSettings settings_;
  hal::TextOutput& output_;
  int map_lines_ = 0;  // lines of the map above the cursor
  Report report_;
  std::mutex lines_mutex_;
  std::string lines_;  // lines that wait to be printed
  std::atomic<bool> end_{false};
  std::thread thread_;
};

}  // namespace touchline
