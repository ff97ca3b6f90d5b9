#pragma once

#include <array>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>

// The container format MCAP (https://mcap.dev/spec, version 0): the part that recordings use. Attachments, metadata
// records and compression are not used.
namespace touchline::hal::mcap {

static_assert(std::endian::native == std::endian::little, "numbers of the file are copied from memory");

/// The file's first and last bytes.
inline constexpr std::string_view kMagic{"\x89MCAP0\r\n", 8};
/// Bytes before the content of each record: operation code and length.
inline constexpr std::size_t kRecordHeaderBytes = 9;
// Offset of the summary, of its offsets, and the checksum.
inline constexpr std::uint64_t kFooterBytes = 8 + 8 + 4;

enum class Opcode : std::uint8_t {
  kHeader = 0x01,
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kMessageIndex = 0x07,
  kChunkIndex = 0x08,
  kStatistics = 0x0B,
  kSummaryOffset = 0x0E,
  kDataEnd = 0x0F,
};

/// Describes the messages of channels. `encoding` is that of `data`: "jsonschema", "ros2msg"; empty: no description.
struct Schema {
  std::uint16_t id = 0;  // from 1 on; channels without a schema have 0
  std::string name, encoding, data;
};

/// A series of messages. `encoding` is that of the messages: "json", "cdr".
struct Channel {
  std::uint16_t id = 0, schema = 0;
  std::string topic, encoding;
};

/// A message. The caller owns what `data` points to.
struct Message {
  std::uint16_t channel = 0;
  std::uint32_t sequence = 0;
  std::uint64_t time_ns = 0;  // since 1970
  std::span<const std::byte> data;
};

inline std::span<const std::byte> bytes_of(std::string_view text) { return std::as_bytes(std::span(text)); }

/// Appends numbers and texts to a record's content.
class RecordWriter {
 public:
  explicit RecordWriter(std::string& out) : out_(out) {}

  template <std::integral T>
  void number(T value) {
    std::array<char, sizeof(T)> bytes;
    std::memcpy(bytes.data(), &value, sizeof(T));
    out_.append(bytes.data(), bytes.size());
  }
  /// Texts and blobs are preceded by their length in 32 bits.
  void text(std::string_view value) {
    number(static_cast<std::uint32_t>(value.size()));
    out_.append(value);
  }
  void raw(std::span<const std::byte> bytes) { out_.append(reinterpret_cast<const char*>(bytes.data()), bytes.size()); }

 private:
  std::string& out_;
};

/// Takes numbers and texts from a record's content. After a read beyond its end, ok() is false and all values are 0 or
/// empty.
class RecordReader {
 public:
  explicit RecordReader(std::span<const std::byte> content) : rest_(content) {}

  template <std::integral T>
  T number() {
    T value{};
    const std::span<const std::byte> bytes = take(sizeof(T));
    if (!bytes.empty()) std::memcpy(&value, bytes.data(), sizeof(T));
    return value;
  }
  std::string text() {
    const std::span<const std::byte> bytes = take(number<std::uint32_t>());
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }
  std::span<const std::byte> take(std::uint64_t count) {
    if (count > rest_.size()) {
      ok_ = false;
      rest_ = {};
      return {};
    }
    const std::span<const std::byte> bytes = rest_.first(static_cast<std::size_t>(count));
    rest_ = rest_.subspan(bytes.size());
    return bytes;
  }
  [[nodiscard]] std::span<const std::byte> rest() const { return rest_; }
  [[nodiscard]] bool ok() const { return ok_; }

 private:
  std::span<const std::byte> rest_;
  bool ok_ = true;
};

}  // namespace touchline::hal::mcap
