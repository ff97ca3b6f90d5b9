#pragma once

#include <atomic>
#include <cstdio>
#include <mutex>
#include <string>
#include <thread>

#include "firmware/loop_report.h"
#include "firmware/service_notifier.h"
#include "firmware/status_text.h"

namespace touchline {

struct ReportPrinterSettings {
  Expectation expected;
  bool status_lines = true;                  // else faults and halts only
  int map_columns = 0;                       // 0: no picture of the field
  const ServiceNotifier* service = nullptr;  // is told the status as well; null: nobody
};

/// Takes the loop's reports from the ring, makes sentences of them and prints: status to `out`, faults to `err`.
/// A terminal that hangs holds up this thread and nobody else.
class ReportPrinter {
 public:
  ReportPrinter(ReportRing& ring, const ReportPrinterSettings& settings, std::FILE* out, std::FILE* err);
  /// Prints what is left.
  ~ReportPrinter();
  /// Prints the line, without its end, to `err` before what comes from the ring. From any thread but the loop's.
  void say(const std::string& line);
  ReportPrinter(const ReportPrinter&) = delete;
  ReportPrinter& operator=(const ReportPrinter&) = delete;

 private:
  void work();
  void print_all();
  void print_waiting();
  void print(const Report& report);
  void print_map(const StatusReport& status);

  ReportRing& ring_;
  const ReportPrinterSettings settings_;
  std::FILE* out_;
  std::FILE* err_;
  int map_lines_ = 0;  // of the picture that stands above the cursor
  Report report_;
  std::mutex saying_;
  std::string said_;
  std::atomic<bool> end_{false};
  std::thread thread_;
};

}  // namespace touchline
