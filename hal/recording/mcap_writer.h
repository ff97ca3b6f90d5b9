#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "hal/recording/mcap_format.h"
#include "hal/result.h"

namespace touchline::hal::mcap {

/// Writes a file in the format MCAP: messages in chunks with checksums, an index, and a summary at the end. If the
/// process ends before close(), readers find everything up to the last whole chunk.
///
/// Errors of all functions: kIo, kFull (no space, or a limit of the file's size); the message names the file. After an
/// error the file is cut to its last whole chunk, and only close() may be called.
class McapWriter {
 public:
  /// The size at which callers write a chunk: a reader of a cut file loses at most this much, and the overhead of 200
  /// bytes does not count.
  static constexpr std::size_t kChunkBytes = std::size_t{1} << 20;

  McapWriter() = default;
  ~McapWriter();
  McapWriter(const McapWriter&) = delete;
  McapWriter& operator=(const McapWriter&) = delete;

  /// Creates the file, which must not exist: kInconsistent. kNotFound, kPermission: the folder is missing or protected.
  /// It is locked (flock) until it is closed, so that other processes can see that it is being written. If its header
  /// cannot be written, the file is removed.
  Result<void> create(const std::string& path, std::string_view library);
  /// Returns the number of the new schema or channel.
  Result<std::uint16_t> add_schema(std::string name, std::string encoding, std::string data);
  Result<std::uint16_t> add_channel(std::uint16_t schema, std::string topic, std::string encoding);
  /// Adds a message to the chunk that is being filled. Its data are `parts`, one after the other; `message.data` is
  /// ignored.
  void add(const Message& message, std::initializer_list<std::span<const std::byte>> parts);
  /// Writes the chunk that is being filled.
  Result<void> flush();
  /// Waits until the disk has everything that was written.
  Result<void> sync();
  /// Writes the last chunk and the summary, and closes the file.
  Result<void> close();
  /// Closes the file and removes it; the writer cannot be used any more.
  void discard();

  [[nodiscard]] bool is_open() const { return file_ >= 0; }
  /// Size of the file without the chunk that is being filled.
  [[nodiscard]] std::uint64_t size() const { return size_; }
  /// Size of the chunk that is being filled.
  [[nodiscard]] std::size_t chunk_bytes() const { return chunk_.size(); }
  /// Number of messages in whole chunks.
  [[nodiscard]] std::uint64_t messages() const { return messages_; }

 private:
  struct ChunkIndex {
    std::uint64_t begin_ns = 0, end_ns = 0, offset = 0, length = 0, index_length = 0, size = 0;
    std::map<std::uint16_t, std::uint64_t> index_offsets;  // by channel
  };
  struct IndexEntry {
    std::uint64_t time_ns, offset;
  };

  Result<void> write(std::string_view bytes);
  Result<void> write_record(Opcode opcode, std::string_view content);
  Result<void> write_summary();
  [[nodiscard]] std::string statistics() const;
  void release();

  std::string path_;
  int file_ = -1;
  bool has_failed_ = false;
  std::uint64_t size_ = 0, messages_ = 0, begin_ns_ = 0, end_ns_ = 0;
  std::vector<Schema> schemas_;
  std::vector<Channel> channels_;
  std::map<std::uint16_t, std::uint64_t> counts_;  // messages by channel
  std::vector<ChunkIndex> chunks_;
  // The chunk that is being filled.
  std::string chunk_;
  std::uint64_t chunk_begin_ns_ = 0, chunk_end_ns_ = 0, chunk_messages_ = 0;
  std::map<std::uint16_t, std::vector<IndexEntry>> index_;
};

}  // namespace touchline::hal::mcap
