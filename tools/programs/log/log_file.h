#pragma once

#include <cstdint>
#include <string>

#include "hal/result.h"

namespace touchline::log {

/// Formats of the files that this program reads.
enum class LogFormat : std::uint8_t {
  kMcap,    // a recording of Touchline, or what touchline-log has made of a game log
  kSslLog,  // a game log of the Small Size League, packed or not
};

/// Tells the format from the file's first bytes. kNotFound, kPermission, kIo; kUnsupported: it is no file;
/// kCorruptFrame: it has another format.
Result<LogFormat> format_of(const std::string& path);

/// Formats of the files that this program writes, from the ending of the name: .mcap, .log or .log.gz, .csv.
enum class OutputFormat : std::uint8_t { kMcap, kSslLog, kCsv };
/// kUnsupported: the name has another ending.
Result<OutputFormat> output_format_of(const std::string& path);

/// kInconsistent: writing `output` would replace `input`.
Result<void> check_output(const std::string& input, const std::string& output);

}  // namespace touchline::log
