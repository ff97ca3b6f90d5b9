#include "hal/recording/mcap_reader.h"

#include <zlib.h>

#include <algorithm>

namespace touchline::hal::mcap {
namespace {

// Chunks of other programs may be larger than ours. A length beyond this limit is damage, and must not use up the
// memory.
constexpr std::uint64_t kMaxRecordBytes = std::uint64_t{1} << 30;

}  // namespace

Result<void> McapReader::open(const std::string& path) {
  TOUCHLINE_TRY(file_.open(path, Links::kFollowed));
  rewind();
  return {};
}

void McapReader::rewind() {
  position_ = kMagic.size();
  chunk_.clear();
  in_chunk_ = 0;
  offset_ = 0;
  is_complete_ = is_damaged_ = is_at_end_ = false;
}

std::uint16_t McapReader::channel_of(std::string_view topic) const {
  const auto found =
      std::find_if(channels_.begin(), channels_.end(), [&](const auto& entry) { return entry.second.topic == topic; });
  return found == channels_.end() ? std::uint16_t{0} : found->first;
}

// Reads the next record of the file into record_, with its header. Returns false if it is not whole.
Result<bool> McapReader::next_record() {
  TOUCHLINE_TRY_ASSIGN(const bool has_header, file_.read(position_, kRecordHeaderBytes, record_));
  if (!has_header) return false;
  RecordReader header(bytes_of(record_));
  static_cast<void>(header.number<std::uint8_t>());
  const auto length = header.number<std::uint64_t>();
  if (length > kMaxRecordBytes) return false;
  return file_.read(position_, kRecordHeaderBytes + length, record_);
}

// Checks the chunk in record_ and moves its records to chunk_. Returns false if it is damaged.
Result<bool> McapReader::open_chunk() {
  RecordReader reader(bytes_of(record_).subspan(kRecordHeaderBytes));
  static_cast<void>(reader.number<std::uint64_t>());  // first and last time
  static_cast<void>(reader.number<std::uint64_t>());
  const auto size = reader.number<std::uint64_t>();
  const auto crc = reader.number<std::uint32_t>();
  const std::string compression = reader.text();
  const std::span<const std::byte> records = reader.take(reader.number<std::uint64_t>());
  if (!reader.ok()) return false;
  if (!compression.empty()) {
    return failure(ErrorCode::kUnsupported,
                   "%s: a chunk is compressed (%s); uncompress the file: mcap compress "
                   "--compression none",
                   file_.path().c_str(), compression.c_str());
  }
  const auto* const bytes = reinterpret_cast<const unsigned char*>(records.data());
  // A checksum of 0 means that there is none.
  if (records.size() != size || (crc != 0 && ::crc32_z(0, bytes, records.size()) != crc)) return false;
  chunk_.assign(reinterpret_cast<const char*>(records.data()), records.size());
  in_chunk_ = 0;
  return true;
}

void McapReader::read_schema(RecordReader reader) {
  Schema schema;
  schema.id = reader.number<std::uint16_t>();
  schema.name = reader.text();
  schema.encoding = reader.text();
  schema.data = reader.text();
  if (reader.ok()) schemas_[schema.id] = std::move(schema);
}

void McapReader::read_channel(RecordReader reader) {
  Channel channel;
  channel.id = reader.number<std::uint16_t>();
  channel.schema = reader.number<std::uint16_t>();
  channel.topic = reader.text();
  channel.encoding = reader.text();
  if (reader.ok()) channels_[channel.id] = std::move(channel);
}

Result<std::optional<Message>> McapReader::next() {
  while (!is_at_end_) {
    while (in_chunk_ < chunk_.size()) {
      RecordReader records(bytes_of(chunk_).subspan(in_chunk_));
      const auto opcode = static_cast<Opcode>(records.number<std::uint8_t>());
      const auto length = records.number<std::uint64_t>();
      RecordReader content(records.take(length));
      if (!records.ok()) break;  // cannot happen in a chunk of ours, whose checksum is right
      in_chunk_ = chunk_.size() - records.rest().size();
      if (opcode == Opcode::kSchema) read_schema(content);
      if (opcode == Opcode::kChannel) read_channel(content);
      if (opcode != Opcode::kMessage) continue;
      Message message;
      message.channel = content.number<std::uint16_t>();
      message.sequence = content.number<std::uint32_t>();
      message.time_ns = content.number<std::uint64_t>();
      static_cast<void>(content.number<std::uint64_t>());
      message.data = content.rest();
      if (content.ok()) return std::optional(message);
    }
    chunk_.clear();
    offset_ = position_;
    TOUCHLINE_TRY_ASSIGN(const bool is_whole, next_record());
    is_at_end_ = !is_whole;
    if (!is_whole) break;
    const auto opcode = static_cast<Opcode>(record_[0]);
    const RecordReader content(bytes_of(record_).subspan(kRecordHeaderBytes));
    if (opcode == Opcode::kSchema) read_schema(content);
    if (opcode == Opcode::kChannel) read_channel(content);
    if (opcode == Opcode::kChunk) {
      TOUCHLINE_TRY_ASSIGN(const bool is_good, open_chunk());
      is_damaged_ = is_at_end_ = !is_good;
      if (!is_good) break;
    }
    is_complete_ = is_at_end_ = opcode == Opcode::kDataEnd;
    position_ += record_.size();
  }
  return std::optional<Message>();
}

}  // namespace touchline::hal::mcap
