#include "hal/recording/mcap_index.h"

#include <zlib.h>

#include <algorithm>

namespace touchline::hal::mcap {
namespace {

// Limits of what is read into memory at once. A chunk of ours has 1 MB and one picture more; the summary has 200 bytes
// for each chunk. A length beyond them is damage.
constexpr std::uint64_t kMaxChunkBytes = std::uint64_t{64} << 20, kMaxSummaryBytes = std::uint64_t{64} << 20;
// Begin, end, size, checksum, an empty compression, and the length of the records.
constexpr std::uint64_t kChunkHeadBytes = 8 + 8 + 8 + 4 + 4 + 8;
constexpr std::uint64_t kMessageHeadBytes = 2 + 4 + 8 + 8;

}  // namespace

Error McapIndex::damage(std::uint64_t offset) const {
  return failure(ErrorCode::kCorruptFrame, "%s: damaged at byte %llu", file_.path().c_str(),
                 static_cast<unsigned long long>(offset));
}

std::uint16_t McapIndex::channel_of(std::string_view topic) const {
  const auto found =
      std::find_if(topics_.begin(), topics_.end(), [&](const auto& entry) { return entry.second == topic; });
  return found == topics_.end() ? std::uint16_t{0} : found->first;
}

// Returns nullopt if the record is not whole.
Result<std::optional<McapIndex::Record>> McapIndex::record_at(std::uint64_t offset) const {
  std::string head;
  TOUCHLINE_TRY_ASSIGN(const bool is_there, file_.read(offset, kRecordHeaderBytes, head));
  if (!is_there) return std::optional<Record>();
  RecordReader reader(bytes_of(head));
  Record record;
  record.opcode = static_cast<Opcode>(reader.number<std::uint8_t>());
  record.length = reader.number<std::uint64_t>();
  if (record.length > file_.size() - offset - kRecordHeaderBytes) return std::optional<Record>();
  return std::optional(record);
}

Result<void> McapIndex::open(const std::string& path, std::size_t max_chunks) {
  max_chunks_ = max_chunks;
  TOUCHLINE_TRY(file_.open(path, Links::kRefused));
  TOUCHLINE_TRY_ASSIGN(is_complete_, open_summary());
  if (is_complete_) return {};
  chunks_.clear();
  topics_.clear();
  return walk();
}

void McapIndex::add_channel(std::span<const std::byte> content) {
  RecordReader reader(content);
  const auto id = reader.number<std::uint16_t>();
  static_cast<void>(reader.number<std::uint16_t>());  // schema
  std::string topic = reader.text();
  if (reader.ok()) topics_[id] = std::move(topic);
}

Result<void> McapIndex::add_chunk(ChunkPlace chunk) {
  if (chunks_.size() >= max_chunks_) {
    return failure(ErrorCode::kFull, "%s: has more than %zu chunks; cut it into several files", file_.path().c_str(),
                   max_chunks_);
  }
  chunks_.push_back(std::move(chunk));
  return {};
}

// Returns false if there is no summary that can be used.
Result<bool> McapIndex::open_summary() {
  const std::uint64_t tail_bytes = kRecordHeaderBytes + kFooterBytes + kMagic.size();
  std::string tail;
  if (file_.size() < tail_bytes) return false;
  TOUCHLINE_TRY_ASSIGN(const bool has_tail, file_.read(file_.size() - tail_bytes, tail_bytes, tail));
  RecordReader footer(bytes_of(tail));
  const auto opcode = static_cast<Opcode>(footer.number<std::uint8_t>());
  const auto length = footer.number<std::uint64_t>();
  const auto begin = footer.number<std::uint64_t>();
  static_cast<void>(footer.number<std::uint64_t>());  // of the summary's offsets
  const auto crc = footer.number<std::uint32_t>();
  if (!has_tail || opcode != Opcode::kFooter || length != kFooterBytes || !tail.ends_with(kMagic) || begin == 0)
    return false;
  const std::uint64_t end = file_.size() - kMagic.size() - sizeof(crc);
  if (begin > end || end - begin > kMaxSummaryBytes) return false;
  std::string summary;
  TOUCHLINE_TRY_ASSIGN(const bool is_whole, file_.read(begin, end - begin, summary));
  const auto* const bytes = reinterpret_cast<const unsigned char*>(summary.data());
  if (!is_whole || (crc != 0 && ::crc32_z(0, bytes, summary.size()) != crc)) return false;
  RecordReader records(bytes_of(summary));
  while (records.ok() && records.rest().size() > kRecordHeaderBytes) {
    const auto kind = static_cast<Opcode>(records.number<std::uint8_t>());
    const std::span<const std::byte> content = records.take(records.number<std::uint64_t>());
    if (kind == Opcode::kChannel) add_channel(content);
    if (kind == Opcode::kFooter) return true;
    if (kind != Opcode::kChunkIndex) continue;
    RecordReader reader(content);
    ChunkPlace chunk;
    static_cast<void>(reader.take(2 * sizeof(std::uint64_t)));  // first and last time
    chunk.offset = reader.number<std::uint64_t>();
    chunk.length = reader.number<std::uint64_t>();
    RecordReader offsets(reader.take(reader.number<std::uint32_t>()));
    while (offsets.ok() && !offsets.rest().empty()) {
      const auto channel = offsets.number<std::uint16_t>();
      chunk.indices.emplace_back(channel, offsets.number<std::uint64_t>());
    }
    static_cast<void>(reader.number<std::uint64_t>());
    const std::string compression = reader.text();
    if (!reader.ok() || !offsets.ok()) return false;
    if (!compression.empty()) {
      return failure(ErrorCode::kUnsupported,
                     "%s: a chunk is compressed (%s); uncompress the file: mcap compress --compression none",
                     file_.path().c_str(), compression.c_str());
    }
    TOUCHLINE_TRY(add_chunk(std::move(chunk)));
  }
  return false;
}

// Lists the chunks of a file without a summary, up to its last whole record.
Result<void> McapIndex::walk() {
  std::uint64_t offset = kMagic.size();
  for (;;) {
    TOUCHLINE_TRY_ASSIGN(const std::optional<Record> record, record_at(offset));
    if (!record || record->opcode == Opcode::kDataEnd) return {};
    const std::uint64_t content = offset + kRecordHeaderBytes;
    if (record->opcode == Opcode::kChunk) TOUCHLINE_TRY(add_chunk({offset, kRecordHeaderBytes + record->length, {}}));
    std::string bytes;
    if (record->opcode == Opcode::kMessageIndex && !chunks_.empty()) {
      TOUCHLINE_TRY_ASSIGN(const bool is_there, file_.read(content, sizeof(std::uint16_t), bytes));
      if (is_there) chunks_.back().indices.emplace_back(RecordReader(bytes_of(bytes)).number<std::uint16_t>(), offset);
    }
    if (record->opcode == Opcode::kChannel && record->length <= kMaxChunkBytes) {
      TOUCHLINE_TRY_ASSIGN(const bool is_there, file_.read(content, record->length, bytes));
      if (is_there) add_channel(bytes_of(bytes));
    }
    offset = content + record->length;
  }
}

Result<std::vector<MessagePlace>> McapIndex::messages(const ChunkPlace& chunk, std::uint16_t channel) const {
  std::vector<MessagePlace> places;
  for (const auto& [number, offset] : chunk.indices) {
    if (number != channel) continue;
    TOUCHLINE_TRY_ASSIGN(const std::optional<Record> record, record_at(offset));
    if (!record || record->opcode != Opcode::kMessageIndex || record->length > kMaxChunkBytes) return damage(offset);
    std::string bytes;
    TOUCHLINE_TRY_ASSIGN(const bool is_there, file_.read(offset + kRecordHeaderBytes, record->length, bytes));
    RecordReader reader(bytes_of(bytes));
    if (!is_there || reader.number<std::uint16_t>() != channel) return damage(offset);
    RecordReader entries(reader.take(reader.number<std::uint32_t>()));
    while (!entries.rest().empty()) {
      MessagePlace place;
      place.time_ns = entries.number<std::uint64_t>();
      place.offset = entries.number<std::uint64_t>();
      places.push_back(place);
    }
    if (!reader.ok() || !entries.ok()) return damage(offset);
  }
  return places;
}

Result<std::string> McapIndex::load(const ChunkPlace& chunk) const {
  std::string record;
  if (chunk.length > kMaxChunkBytes || chunk.length < kRecordHeaderBytes + kChunkHeadBytes) return damage(chunk.offset);
  TOUCHLINE_TRY_ASSIGN(const bool is_there, file_.read(chunk.offset, chunk.length, record));
  RecordReader reader(bytes_of(record));
  const bool is_chunk = static_cast<Opcode>(reader.number<std::uint8_t>()) == Opcode::kChunk;
  static_cast<void>(reader.take(3 * sizeof(std::uint64_t)));  // length, first and last time
  const auto size = reader.number<std::uint64_t>();
  const auto crc = reader.number<std::uint32_t>();
  const std::string compression = reader.text();
  const std::span<const std::byte> records = reader.take(reader.number<std::uint64_t>());
  if (!is_there || !is_chunk || !reader.ok() || !compression.empty() || records.size() != size)
    return damage(chunk.offset);
  const auto* const bytes = reinterpret_cast<const unsigned char*>(records.data());
  if (crc != 0 && ::crc32_z(0, bytes, records.size()) != crc) return damage(chunk.offset);
  return std::string(reinterpret_cast<const char*>(records.data()), records.size());
}

Result<std::span<const std::byte>> McapIndex::find(const std::string& records, const MessagePlace& place,
                                                   std::uint16_t channel) const {
  if (place.offset > records.size()) return damage(place.offset);
  RecordReader reader(bytes_of(records).subspan(static_cast<std::size_t>(place.offset)));
  const bool is_message = static_cast<Opcode>(reader.number<std::uint8_t>()) == Opcode::kMessage;
  RecordReader content(reader.take(reader.number<std::uint64_t>()));
  const bool is_of_channel = content.number<std::uint16_t>() == channel;
  static_cast<void>(content.take(kMessageHeadBytes - sizeof(std::uint16_t)));
  if (!is_message || !is_of_channel || !content.ok()) return damage(place.offset);
  return content.rest();
}

Result<std::string> McapIndex::read(const ChunkPlace& chunk, const MessagePlace& place, std::uint16_t channel) const {
  const std::uint64_t offset = chunk.offset + kRecordHeaderBytes + kChunkHeadBytes + place.offset;
  if (place.offset > chunk.length) return damage(chunk.offset);
  TOUCHLINE_TRY_ASSIGN(const std::optional<Record> record, record_at(offset));
  if (!record || record->length > kMaxChunkBytes) return damage(offset);
  std::string bytes;
  TOUCHLINE_TRY_ASSIGN(const bool is_there, file_.read(offset, kRecordHeaderBytes + record->length, bytes));
  if (!is_there) return damage(offset);
  TOUCHLINE_TRY_ASSIGN(const std::span<const std::byte> data, find(bytes, {place.time_ns, 0}, channel));
  return std::string(reinterpret_cast<const char*>(data.data()), data.size());
}

}  // namespace touchline::hal::mcap
