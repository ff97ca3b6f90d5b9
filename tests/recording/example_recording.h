#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hal/recording/mcap_reader.h"
#include "hal/recording/mcap_writer.h"

namespace touchline::testing {

/// A message as it was written.
struct WrittenMessage {
  std::string topic, data;
  std::uint32_t sequence = 0;
  std::uint64_t time_ns = 0;

  friend bool operator==(const WrittenMessage&, const WrittenMessage&) = default;
};

/// Writes a recording of two channels with `chunks` chunks of some messages each, whose sizes differ. Returns the
/// messages by chunk.
std::vector<std::vector<WrittenMessage>> write_example(const std::string& path, int chunks);

/// What a reader finds in a file.
struct ReadMessages {
  std::vector<WrittenMessage> messages;
  bool is_complete = false, is_damaged = false;
  std::uint64_t rest = 0;
};
ReadMessages read_all(const std::string& path);

}  // namespace touchline::testing
