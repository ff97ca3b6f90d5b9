#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "hal/recording/mcap_file.h"
#include "hal/recording/mcap_format.h"
#include "hal/result.h"

namespace touchline::hal::mcap {

/// Reads a file in the format MCAP from its beginning to its end, in the order in which it was written. It needs
/// neither index nor summary: a file that was cut off is read up to its last whole chunk. Chunks must not be
/// compressed.
class McapReader {
 public:
  /// Opens the file and reads its header. kNotFound, kPermission, kIo; kCorruptFrame: it is not in this format.
  Result<void> open(const std::string& path);
  /// Returns the next message, whose data are valid until the next call; nullopt: there is no further one, see
  /// is_complete() and rest(). kUnsupported: a chunk is compressed. kIo: the disk fails.
  Result<std::optional<Message>> next();
  /// Starts again from the beginning.
  void rewind();

  /// Channels and schemas up to the last message, by their numbers.
  [[nodiscard]] const std::map<std::uint16_t, Channel>& channels() const { return channels_; }
  [[nodiscard]] const std::map<std::uint16_t, Schema>& schemas() const { return schemas_; }
  /// Returns the channel's number; 0: there is no such channel up to the last message.
  [[nodiscard]] std::uint16_t channel_of(std::string_view topic) const;

  /// Returns the byte of the file at which the last message's chunk begins; after the last message, the byte from which
  /// on nothing was read.
  [[nodiscard]] std::uint64_t offset() const { return offset_; }

  // Valid after the last message.
  /// Returns whether the file has its end.
  [[nodiscard]] bool is_complete() const { return is_complete_; }
  /// Returns the number of bytes after the last whole chunk; 0 if the file is complete.
  [[nodiscard]] std::uint64_t rest() const { return is_complete_ ? 0 : file_.size() - position_; }
  /// Returns whether the last record is whole, but not as it was written.
  [[nodiscard]] bool is_damaged() const { return is_damaged_; }
  [[nodiscard]] std::uint64_t size() const { return file_.size(); }

 private:
  Result<bool> next_record();
  Result<bool> open_chunk();
  void read_schema(RecordReader reader);
  void read_channel(RecordReader reader);

  McapFile file_;
  std::uint64_t position_ = 0;  // of the record after the last whole one
  std::uint64_t offset_ = 0;
  std::string record_, chunk_;
  std::size_t in_chunk_ = 0;  // position of the next record in chunk_
  bool is_complete_ = false, is_damaged_ = false, is_at_end_ = false;
  std::map<std::uint16_t, Channel> channels_;
  std::map<std::uint16_t, Schema> schemas_;
};

}  // namespace touchline::hal::mcap
