#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>

#include "hal/recording/mcap_reader.h"
#include "hal/recording/mcap_writer.h"
#include "hal/result.h"

namespace touchline::log {

/// Copies messages of one or several recordings into a new one. Channels of the same topic and kind become one. A file
/// that was not finished is removed.
class RecordingCopy {
 public:
  RecordingCopy() = default;
  ~RecordingCopy();
  RecordingCopy(const RecordingCopy&) = delete;
  RecordingCopy& operator=(const RecordingCopy&) = delete;

  /// Errors of McapWriter::create(): the file must not exist.
  Result<void> create(const std::string& path);
  /// The channels of messages that follow are those of `file`.
  void begin(const hal::mcap::McapReader& file);
  /// Adds a message of the file with this channel. Errors of McapWriter.
  Result<void> add(const hal::mcap::Message& message);
  Result<void> finish();

 private:
  using ChannelKind = std::pair<std::string, std::string>;  // topic and name of the schema
  Result<std::uint16_t> channel_for(std::uint16_t channel);

  hal::mcap::McapWriter writer_;
  const hal::mcap::McapReader* file_ = nullptr;
  std::map<std::uint16_t, std::uint16_t> channels_;  // of the file: its numbers and ours
  std::map<ChannelKind, std::uint16_t> known_;
};

}  // namespace touchline::log
