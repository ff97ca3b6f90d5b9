#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "hal/result.h"

namespace touchline::log {

struct Conversion {
  std::uint64_t written = 0;       // messages or rows
  std::vector<std::string> notes;  // what a person should know: a file that was cut off
};

/// Converts between recordings, game logs and CSV, as the names of the files tell:
/// - a recording to a game log: detections (type 4), tracks (type 5), and the field once a second;
/// - a game log to MCAP and back: the bytes of all messages, unchanged;
/// - a game log to a game log: packs or unpacks it;
/// - both to CSV.
/// kUnsupported: there is no such conversion. Other errors name the file and the byte.
Result<Conversion> convert(const std::string& input, const std::string& output);

/// Topic of a game log's message in MCAP: "/ssl/vision", "/ssl/type/9".
std::string topic_of(std::int32_t type, std::int64_t time_ns);
/// Returns the type of a topic's messages; nullopt: it is not of a game log.
std::optional<std::int32_t> type_of(const std::string& topic);

}  // namespace touchline::log
