#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "hal/recording/mcap_file.h"
#include "hal/recording/mcap_format.h"
#include "hal/result.h"

namespace touchline::hal::mcap {

/// A chunk of the file, and where the index of its messages lies, by channel.
struct ChunkPlace {
  std::uint64_t offset = 0, length = 0;  // of the whole record
  std::vector<std::pair<std::uint16_t, std::uint64_t>> indices;
};

/// A message in a chunk.
struct MessagePlace {
  std::uint64_t time_ns = 0;
  std::uint64_t offset = 0;  // in the chunk's records
};

/// Finds messages of a file in the format MCAP without reading what lies between them: from the summary at the file's
/// end, or, if it was cut off or is still being written, from the chunks' headers. Chunks must not be compressed.
class McapIndex {
 public:
  /// Opens a file, not a link to one, and lists its chunks. kNotFound, kPermission, kIo; kCorruptFrame: it is not in
  /// this format; kUnsupported: a chunk is compressed; kFull: it has more than `max_chunks`.
  Result<void> open(const std::string& path, std::size_t max_chunks);

  [[nodiscard]] const std::vector<ChunkPlace>& chunks() const { return chunks_; }
  /// Returns the channel's number; 0: there is none.
  [[nodiscard]] std::uint16_t channel_of(std::string_view topic) const;
  /// Returns whether the file has its end.
  [[nodiscard]] bool is_complete() const { return is_complete_; }
  [[nodiscard]] std::uint64_t size() const { return file_.size(); }

  /// Returns the messages of a channel in a chunk, in their order. kCorruptFrame: the index is damaged.
  Result<std::vector<MessagePlace>> messages(const ChunkPlace& chunk, std::uint16_t channel) const;
  /// Reads the chunk's records and checks them. kCorruptFrame: the chunk is damaged.
  Result<std::string> load(const ChunkPlace& chunk) const;
  /// Reads a single message without a check of its chunk. kCorruptFrame: there is no message of the channel.
  Result<std::string> read(const ChunkPlace& chunk, const MessagePlace& place, std::uint16_t channel) const;
  /// Returns the message's data in records that load() has returned. kCorruptFrame as for read().
  Result<std::span<const std::byte>> find(const std::string& records, const MessagePlace& place,
                                          std::uint16_t channel) const;

 private:
  struct Record {
    Opcode opcode{};
    std::uint64_t length = 0;  // of the content
  };
  Result<std::optional<Record>> record_at(std::uint64_t offset) const;
  Result<bool> open_summary();
  Result<void> walk();
  Result<void> add_chunk(ChunkPlace chunk);
  void add_channel(std::span<const std::byte> content);
  [[nodiscard]] Error damage(std::uint64_t offset) const;

  McapFile file_;
  std::size_t max_chunks_ = 0;
  bool is_complete_ = false;
  std::vector<ChunkPlace> chunks_;
  std::map<std::uint16_t, std::string> topics_;
};

}  // namespace touchline::hal::mcap
