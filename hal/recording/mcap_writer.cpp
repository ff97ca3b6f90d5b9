#include "hal/recording/mcap_writer.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace touchline::hal::mcap {
namespace {

constexpr mode_t kFileMode = 0666;  // less the umask

std::uint32_t checksum(std::string_view bytes, std::uint32_t former = 0) {
  return static_cast<std::uint32_t>(
      ::crc32_z(former, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
}

std::string record(Opcode opcode, std::string_view content) {
  std::string out;
  RecordWriter writer(out);
  writer.number(static_cast<std::uint8_t>(opcode));
  writer.number(std::uint64_t{content.size()});
  out.append(content);
  return out;
}

std::string content_of(const Schema& schema) {
  std::string out;
  RecordWriter writer(out);
  writer.number(schema.id);
  writer.text(schema.name);
  writer.text(schema.encoding);
  writer.text(schema.data);
  return out;
}

std::string content_of(const Channel& channel) {
  std::string out;
  RecordWriter writer(out);
  writer.number(channel.id);
  writer.number(channel.schema);
  writer.text(channel.topic);
  writer.text(channel.encoding);
  writer.text({});  // a map of metadata
  return out;
}

// A map from channel numbers to 64-bit numbers, preceded by its length in bytes.
void write_map(RecordWriter& writer, const std::map<std::uint16_t, std::uint64_t>& map) {
  constexpr std::uint32_t kEntryBytes = sizeof(std::uint16_t) + sizeof(std::uint64_t);
  writer.number(static_cast<std::uint32_t>(map.size()) * kEntryBytes);
  for (const auto& [channel, value] : map) {
    writer.number(channel);
    writer.number(value);
  }
}

Error create_error(const std::string& path, int error) {
  const ErrorCode code = error == EEXIST                                       ? ErrorCode::kInconsistent
                         : error == ENOENT || error == ENOTDIR                 ? ErrorCode::kNotFound
                         : error == EACCES || error == EPERM || error == EROFS ? ErrorCode::kPermission
                         : error == ENOSPC || error == EDQUOT                  ? ErrorCode::kFull
                                                                               : ErrorCode::kIo;
  return failure(code, "%s: cannot be created: %s", path.c_str(), std::strerror(error));
}

}  // namespace

McapWriter::~McapWriter() { release(); }

void McapWriter::release() {
  if (file_ >= 0) ::close(file_);
  file_ = -1;
}

Result<void> McapWriter::create(const std::string& path, std::string_view library) {
  path_ = path;
  file_ = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, kFileMode);
  if (file_ < 0) return create_error(path, errno);
  static_cast<void>(::flock(file_, LOCK_EX | LOCK_NB));  // not every file system has locks
  chunk_.reserve(2 * kChunkBytes);
  std::string header;
  RecordWriter writer(header);
  writer.text({});  // no profile
  writer.text(library);
  Result<void> written = write(kMagic);
  if (written.ok()) written = write_record(Opcode::kHeader, header);
  if (!written.ok()) discard();
  return written;
}

Result<std::uint16_t> McapWriter::add_schema(std::string name, std::string encoding, std::string data) {
  const auto id = static_cast<std::uint16_t>(schemas_.size() + 1);
  schemas_.push_back({id, std::move(name), std::move(encoding), std::move(data)});
  TOUCHLINE_TRY(write_record(Opcode::kSchema, content_of(schemas_.back())));
  return id;
}

Result<std::uint16_t> McapWriter::add_channel(std::uint16_t schema, std::string topic, std::string encoding) {
  const auto id = static_cast<std::uint16_t>(channels_.size() + 1);
  channels_.push_back({id, schema, std::move(topic), std::move(encoding)});
  TOUCHLINE_TRY(write_record(Opcode::kChannel, content_of(channels_.back())));
  return id;
}

void McapWriter::add(const Message& message, std::initializer_list<std::span<const std::byte>> parts) {
  constexpr std::size_t kMessageHeaderBytes = 22;
  std::size_t bytes = 0;
  for (const auto& part : parts) bytes += part.size();
  const std::uint64_t begin = chunk_messages_ == 0 ? message.time_ns : chunk_begin_ns_;
  index_[message.channel].push_back({message.time_ns, chunk_.size()});
  chunk_begin_ns_ = std::min(begin, message.time_ns);
  chunk_end_ns_ = std::max(chunk_messages_ == 0 ? message.time_ns : chunk_end_ns_, message.time_ns);
  ++chunk_messages_;
  RecordWriter writer(chunk_);
  writer.number(static_cast<std::uint8_t>(Opcode::kMessage));
  writer.number(std::uint64_t{kMessageHeaderBytes + bytes});
  writer.number(message.channel);
  writer.number(message.sequence);
  writer.number(message.time_ns);  // when it was recorded
  writer.number(message.time_ns);  // when it was published
  for (const auto& part : parts) writer.raw(part);
}

Result<void> McapWriter::flush() {
  if (chunk_messages_ == 0) return {};
  std::string head;
  RecordWriter writer(head);
  const std::uint64_t size = chunk_.size();
  constexpr std::uint64_t kFieldBytes = 8 + 8 + 8 + 4 + 4 + 8;
  writer.number(static_cast<std::uint8_t>(Opcode::kChunk));
  writer.number(kFieldBytes + size);
  writer.number(chunk_begin_ns_);
  writer.number(chunk_end_ns_);
  writer.number(size);
  writer.number(checksum(chunk_));
  writer.text({});  // no compression
  writer.number(size);

  ChunkIndex index;
  index.begin_ns = chunk_begin_ns_;
  index.end_ns = chunk_end_ns_;
  index.offset = size_;
  index.length = head.size() + size;
  index.size = size;
  std::string records;
  for (const auto& [channel, entries] : index_) {
    if (entries.empty()) continue;
    index.index_offsets[channel] = size_ + index.length + records.size();
    std::string content;
    RecordWriter entry_writer(content);
    entry_writer.number(channel);
    entry_writer.number(static_cast<std::uint32_t>(entries.size() * sizeof(IndexEntry)));
    for (const IndexEntry& entry : entries) {
      entry_writer.number(entry.time_ns);
      entry_writer.number(entry.offset);
    }
    records += record(Opcode::kMessageIndex, content);
  }
  index.index_length = records.size();
  // One write, so that a full disk cuts a chunk at most once.
  chunk_.insert(0, head);
  chunk_ += records;
  TOUCHLINE_TRY(write(chunk_));
  begin_ns_ = messages_ == 0 ? chunk_begin_ns_ : std::min(begin_ns_, chunk_begin_ns_);
  end_ns_ = std::max(end_ns_, chunk_end_ns_);
  messages_ += chunk_messages_;
  for (auto& [channel, entries] : index_) {
    counts_[channel] += entries.size();
    entries.clear();
  }
  chunks_.push_back(std::move(index));
  chunk_.clear();
  chunk_messages_ = 0;
  return {};
}

Result<void> McapWriter::sync() {
  if (has_failed_ || ::fdatasync(file_) == 0) return {};
  has_failed_ = true;
  return failure(ErrorCode::kIo, "%s: the disk did not take it: %s", path_.c_str(), std::strerror(errno));
}

Result<void> McapWriter::close() {
  if (!is_open()) return {};
  // After a failed write the summary may still fit, because a chunk is larger.
  Result<void> result = has_failed_ ? Result<void>() : flush();
  has_failed_ = false;
  const Result<void> summary = write_summary();
  if (result.ok()) result = summary;
  if (result.ok()) result = sync();
  release();
  return result;
}

void McapWriter::discard() {
  if (is_open()) ::unlink(path_.c_str());
  release();
}

Result<void> McapWriter::write(std::string_view bytes) {
  if (has_failed_) return failure(ErrorCode::kIo, "%s: a former write failed", path_.c_str());
  std::string_view rest = bytes;
  while (!rest.empty()) {
    const ssize_t count = ::write(file_, rest.data(), rest.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) {
      const int error = count < 0 ? errno : ENOSPC;
      has_failed_ = true;
      // What the disk has of an incomplete record is removed; readers would skip it too.
      const bool is_cut = ::ftruncate(file_, static_cast<off_t>(size_)) == 0;
      if (is_cut) static_cast<void>(::lseek(file_, static_cast<off_t>(size_), SEEK_SET));
      const bool is_full = error == ENOSPC || error == EDQUOT || error == EFBIG;
      return failure(is_full ? ErrorCode::kFull : ErrorCode::kIo, "%s: %s", path_.c_str(), std::strerror(error));
    }
    rest.remove_prefix(static_cast<std::size_t>(count));
  }
  size_ += bytes.size();
  return {};
}

Result<void> McapWriter::write_record(Opcode opcode, std::string_view content) {
  return write(record(opcode, content));
}

std::string McapWriter::statistics() const {
  std::string out;
  RecordWriter writer(out);
  writer.number(messages_);
  writer.number(static_cast<std::uint16_t>(schemas_.size()));
  writer.number(static_cast<std::uint32_t>(channels_.size()));
  writer.number(std::uint32_t{0});  // attachments
  writer.number(std::uint32_t{0});  // metadata
  writer.number(static_cast<std::uint32_t>(chunks_.size()));
  writer.number(begin_ns_);
  writer.number(end_ns_);
  write_map(writer, counts_);
  return out;
}

Result<void> McapWriter::write_summary() {
  std::string text;
  RecordWriter(text).number(std::uint32_t{0});  // the data have no checksum besides those of the chunks
  std::string out = record(Opcode::kDataEnd, text);
  const std::size_t data_end_bytes = out.size();
  const std::uint64_t summary_begin = size_ + data_end_bytes;
  std::string offsets;
  const auto add_group = [&](Opcode opcode, const std::string& records) {
    if (records.empty()) return;
    std::string content;
    RecordWriter writer(content);
    writer.number(static_cast<std::uint8_t>(opcode));
    writer.number(size_ + out.size());
    writer.number(std::uint64_t{records.size()});
    offsets += record(Opcode::kSummaryOffset, content);
    out += records;
  };
  std::string group;
  for (const Schema& schema : schemas_) group += record(Opcode::kSchema, content_of(schema));
  add_group(Opcode::kSchema, group);
  group.clear();
  for (const Channel& channel : channels_) group += record(Opcode::kChannel, content_of(channel));
  add_group(Opcode::kChannel, group);
  add_group(Opcode::kStatistics, record(Opcode::kStatistics, statistics()));
  group.clear();
  for (const ChunkIndex& chunk : chunks_) {
    std::string content;
    RecordWriter writer(content);
    writer.number(chunk.begin_ns);
    writer.number(chunk.end_ns);
    writer.number(chunk.offset);
    writer.number(chunk.length);
    write_map(writer, chunk.index_offsets);
    writer.number(chunk.index_length);
    writer.text({});  // no compression
    writer.number(chunk.size);
    writer.number(chunk.size);
    group += record(Opcode::kChunkIndex, content);
  }
  add_group(Opcode::kChunkIndex, group);
  const std::uint64_t offsets_begin = size_ + out.size();
  out += offsets;
  RecordWriter writer(out);
  writer.number(static_cast<std::uint8_t>(Opcode::kFooter));
  writer.number(kFooterBytes);
  writer.number(summary_begin);
  writer.number(offsets_begin);
  // The checksum covers the summary and the footer up to here.
  writer.number(checksum(std::string_view(out).substr(data_end_bytes)));
  out += kMagic;
  return write(out);
}

}  // namespace touchline::hal::mcap
