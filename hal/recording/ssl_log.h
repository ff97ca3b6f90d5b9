#pragma once

#include <zlib.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "hal/files/output_file.h"
#include "hal/result.h"

// Game logs of RoboCup's Small Size League, as its tools write and play them (RoboCup-SSL/ssl-go-tools, package
// persistence): "SSL_LOG_FILE", version 1, then messages. All numbers are big-endian. A file may be packed with gzip.
namespace touchline::hal {

/// Types of messages; a file may have others.
enum SslLogType : std::int32_t {
  kSslBlank = 0,
  kSslUnknown = 1,     // its reader has to guess
  kSslVision2010 = 2,  // SSL_WrapperPacket without the newer fields
  kSslReferee = 3,     // Referee
  kSslVision = 4,      // SSL_WrapperPacket
  kSslTracker = 5,     // TrackerWrapperPacket
  kSslIndex = 6,       // byte offsets of the messages; the last one of a file
};

struct SslLogMessage {
  std::int64_t time_ns = 0;         // Unix time at which the logger received it; an index has 0
  std::int32_t type = kSslUnknown;  // SslLogType
  std::span<const std::byte> data;  // the datagram
};

/// Reads a log from its beginning to its end, whether or not it is packed. A file that was cut off is read up to its
/// last whole message. Byte offsets are those of the unpacked file.
class SslLogReader {
 public:
  SslLogReader() = default;
  ~SslLogReader();
  SslLogReader(const SslLogReader&) = delete;
  SslLogReader& operator=(const SslLogReader&) = delete;

  /// Opens the file and reads its header. kNotFound, kPermission, kIo; kCorruptFrame: it is not in this format;
  /// kUnsupported: it is no file, or has another version.
  Result<void> open(const std::string& path);
  /// Returns the next message, whose data are valid until the next call; nullopt: there is no further one, see
  /// is_complete(). kCorruptFrame: the file is damaged; the message names file and byte.
  Result<std::optional<SslLogMessage>> next();
  /// Starts again from the beginning.
  Result<void> rewind();

  /// Returns the offset of the next message.
  [[nodiscard]] std::uint64_t position() const { return position_; }
  // Valid after the last message.
  /// Returns whether the file ends with a whole message.
  [[nodiscard]] bool is_complete() const { return is_complete_; }

 private:
  /// Returns the number of bytes that are left, at most `count`.
  Result<std::size_t> load(std::byte* to, std::size_t count);
  Result<void> read_header();
  [[nodiscard]] Error error_at(ErrorCode code, const std::string& what) const;

  std::string path_;
  gzFile file_ = nullptr;
  std::uint64_t position_ = 0;
  bool is_complete_ = false;
  std::string data_;
};

/// Returns whether a file's first bytes are those of a log, or of a file that gzip has packed.
bool is_ssl_log(std::string_view first_bytes);

/// Writes a log; its name ends in .gz: packed with gzip. The file appears when it is complete. Errors are those of
/// OutputFile.
class SslLogWriter {
 public:
  SslLogWriter() = default;
  ~SslLogWriter();
  SslLogWriter(const SslLogWriter&) = delete;
  SslLogWriter& operator=(const SslLogWriter&) = delete;

  Result<void> open(const std::string& path);
  Result<void> add(const SslLogMessage& message);
  /// Gives the file its name.
  Result<void> commit();

 private:
  Result<void> write(std::span<const std::byte> bytes);
  Result<void> pack(std::span<const std::byte> bytes, bool is_last);

  OutputFile file_;
  z_stream packer_{};
  bool is_packed_ = false;
};

}  // namespace touchline::hal
