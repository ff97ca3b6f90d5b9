#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "firmware/console/messages.h"

namespace touchline::console {

/// A bug report contains the results of this time before it.
inline constexpr Duration kBugReportTime = std::chrono::seconds(10);

/// Content of a bug report. It is a copy of the console thread's data, so that another thread can work on it.
struct BugReportContent {
  Scene scene;
  Instant made{};
  hal::UnixTimeOffset unix_time;
  std::string hello, status;        // as sent to a client
  std::vector<Event> events;        // oldest first
  std::vector<Snapshot> snapshots;  // oldest first
  ConsoleInput console;
  Frame frame;                       // A width of 0 means that there is no picture. The planes are in `pixels`,
  std::vector<std::uint8_t> pixels;  // in the layout of picture_layout(), without padding
  std::string secret;                // text that is removed from all files; "": none
};

/// Returns "touchline-bug-report-20261123-211502", UTC: the archive's name without extension, and the folder in the
/// archive.
std::string bug_report_name(const BugReportContent& content);
/// Returns a .tar.gz file (docs/console.md). Reads the files that the configuration names, and facts about the machine;
/// writes nothing. Files that cannot be read are missing, and README.txt says why. Throws std::bad_alloc if memory runs
/// out.
std::string make_bug_report(const BugReportContent& content);

}  // namespace touchline::console
