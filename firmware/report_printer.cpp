#include "firmware/report_printer.h"

#include <algorithm>
#include <chrono>

namespace touchline {

// Interval at which the ring is polled: fast enough for a reader, and the loop needs no system call to wake this
// thread.
constexpr auto kPrintPeriod = std::chrono::milliseconds(20);

ReportPrinter::ReportPrinter(ReportRing& ring, const ReportPrinterSettings& settings, hal::TextOutput& output)
    : ring_(ring), settings_(settings), output_(output) {
  thread_ = std::thread([this] { work(); });
}

ReportPrinter::~ReportPrinter() {
  end_.store(true, std::memory_order_release);
  thread_.join();
}

void ReportPrinter::work() {
  while (!end_.load(std::memory_order_acquire)) {
    print_all();
    std::this_thread::sleep_for(kPrintPeriod);
  }
  print_all();
  if (const auto dropped = ring_.dropped(); dropped > 0) {
    output_.print_error(std::to_string(dropped) +
                        " reports were dropped because they came faster than they could be printed\n");
  }
}

void ReportPrinter::print_line(const std::string& line) {
  const std::scoped_lock lock(lines_mutex_);
  lines_ += line + "\n";
}

void ReportPrinter::print_all() {
  try {
    print_waiting();
  } catch (...) {  // out of memory: this report is lost, the game continues
  }
}

void ReportPrinter::print_waiting() {
  std::string lines;
  {
    const std::scoped_lock lock(lines_mutex_);
    lines.swap(lines_);
  }
  if (!lines.empty()) {
    for (std::size_t begin = 0, end = 0; (end = lines.find('\n', begin)) != std::string::npos; begin = end + 1) {
      print_event("info", lines.substr(begin, end - begin));
    }
  }
  while (ring_.pop(report_)) print(report_);
}

std::string ReportPrinter::line_of(const StatusReport& status) const {
  return status_line(status, settings_.expected) + (settings_.network ? settings_.network() : std::string());
}

void ReportPrinter::print(const Report& report) {
  switch (report.kind) {
    case Report::Kind::kStatus:
      if (settings_.on_status) settings_.on_status(report.status);
      if (settings_.service != nullptr) settings_.service->status(line_of(report.status));
      if (settings_.map_columns > 0) {
        print_map(report.status);
      } else if (settings_.status_lines) {
        output_.print(line_of(report.status) + "\n");
      }
      return;
    case Report::Kind::kFault:
      return print_event("error", fault_line(report.fault));
    case Report::Kind::kHalt:
      if (settings_.on_halt) settings_.on_halt(report.halt);
      if (report.halt.halt == report.halt.before) return;
      return print_event(report.halt.halt == kHaltNone ? "info" : "warning", halt_line(report.halt));
    case Report::Kind::kBattery:
      return print_event("warning", battery_line(report.battery));
    case Report::Kind::kDrive:
      return print_event("warning", drive_line(report.drive));
    case Report::Kind::kStanding:
      return print_event("warning", standing_line(report.standing));
  }
}

void ReportPrinter::print_event(const char* level, const std::string& line) {
  output_.print_error(line + "\n");
  if (settings_.on_event) settings_.on_event(level, line);
  map_lines_ = 0;  // the next map is drawn below this line
}

void ReportPrinter::print_map(const StatusReport& status) {
  std::string text = field_map(status, settings_.expected.field, settings_.map_columns, settings_.map_colors);
  std::string line = line_of(status);
  // The status is split into several lines, because a line that the terminal wraps would move the map down.
  for (const char* const piece : {"  latency", "  robots", "  network"}) {
    if (const std::size_t cut = line.find(piece); cut != std::string::npos) line.replace(cut, 2, "\x1b[K\n");
  }
  text += line;
  // Moves the cursor up to draw over the last map.
  const std::string up = map_lines_ > 0 ? "\x1b[" + std::to_string(map_lines_) + "A" : std::string();
  output_.print(up + "\x1b[?7l" + text + "\x1b[K\n\x1b[?7h");  // line wrapping is off while the map is printed
  map_lines_ = static_cast<int>(std::count(text.begin(), text.end(), '\n')) + 1;
}

}  // namespace touchline
