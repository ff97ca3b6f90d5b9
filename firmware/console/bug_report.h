#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "firmware/console/messages.h"

namespace touchline::console {

/// Time before a bug report whose results it contains.
inline constexpr Duration kBugReportTime = std::chrono::seconds(10);

/// Content of a bug report. It is a copy of what the console's thread knows, so that another thread can work on it.
struct BugReportContent {
  Scene scene;
  Instant made{};
  hal::UnixTimeOffset unix_time;
  std::string hello, status;        // as a client gets them
  std::vector<Event> events;        // oldest first
  std::vector<Snapshot> snapshots;  // oldest first
  ConsoleInput console;
  Frame frame;                       // a width of 0: there is no picture. Its planes are in `pixels`
  std::vector<std::uint8_t> pixels;  // as picture_layout() without padding
  std::string secret;                // is removed from all texts; "": there is none
};

/// "touchline-bug-report-20261123-211502", UTC: the archive's name without its extension, and the folder in it.
std::string bug_report_name(const BugReportContent& content);
/// A .tar.gz file (docs/console.md). Reads the files that the configuration names, and facts about the machine; writes
/// nothing. Files that cannot be read are missing, and README.txt says why. Throws std::bad_alloc if memory is short.
std::string make_bug_report(const BugReportContent& content);

}  // namespace touchline::console
