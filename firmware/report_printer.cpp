#include "firmware/report_printer.h"

#include <algorithm>
#include <chrono>

namespace touchline {

// Fast enough for a reader, and the loop needs no system call to wake this thread.
constexpr auto kPrintPeriod = std::chrono::milliseconds(20);

ReportPrinter::ReportPrinter(ReportRing& ring, const ReportPrinterSettings& settings, std::FILE* out, std::FILE* err)
    : ring_(ring), settings_(settings), out_(out), err_(err) {
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
    std::fprintf(err_, "%llu reports were dropped because they came faster than they could be printed\n",
                 static_cast<unsigned long long>(dropped));
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
        std::fprintf(out_, "%s\n", line_of(report.status).c_str());
      }
      std::fflush(out_);
      return;
    case Report::Kind::kFault:
      return print_event("error", fault_line(report.fault));
    case Report::Kind::kHalt:
      if (settings_.on_halt) settings_.on_halt(report.halt.halt);
      return print_event(report.halt.halt == kHaltNone ? "info" : "warning", halt_line(report.halt));
    case Report::Kind::kBattery:
      return print_event("warning", battery_line(report.battery));
    case Report::Kind::kStanding:
      return print_event("warning", standing_line(report.standing));
  }
}

void ReportPrinter::print_event(const char* level, const std::string& line) {
  std::fprintf(err_, "%s\n", line.c_str());
  if (settings_.on_event) settings_.on_event(level, line);
  map_lines_ = 0;  // the next map is drawn below this line
}

void ReportPrinter::print_map(const StatusReport& status) {
  std::string text = field_map(status, settings_.expected.field, settings_.map_columns, true);
  std::string line = line_of(status);
  // In several lines, because a line that the terminal wraps would move the map down.
  for (const char* const piece : {"  latency", "  robots", "  network"}) {
    if (const std::size_t cut = line.find(piece); cut != std::string::npos) line.replace(cut, 2, "\x1b[K\n");
  }
  text += line;
  if (map_lines_ > 0) std::fprintf(out_, "\x1b[%dA", map_lines_);  // moves the cursor up to draw over the last map
  std::fprintf(out_, "\x1b[?7l%s\x1b[K\n\x1b[?7h", text.c_str());  // line wrapping is off meanwhile
  map_lines_ = static_cast<int>(std::count(text.begin(), text.end(), '\n')) + 1;
}

}  // namespace touchline
