#include "hal/recording/mcap_reader.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace touchline::hal::mcap {
namespace {

// Chunks of other programs may be larger than ours. A length beyond this limit is damage, and must not use up the
// memory.
constexpr std::uint64_t kMaxRecordBytes = std::uint64_t{1} << 30;

}  // namespace

McapReader::~McapReader() {
  if (file_ >= 0) ::close(file_);
}

Result<void> McapReader::open(const std::string& path) {
  path_ = path;
  file_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  struct stat status {};
  if (file_ < 0 || ::fstat(file_, &status) != 0) {
    const ErrorCode code = errno == ENOENT || errno == ENOTDIR ? ErrorCode::kNotFound
                           : errno == EACCES                   ? ErrorCode::kPermission
                                                               : ErrorCode::kIo;
    return failure(code, "%s: cannot be opened: %s", path.c_str(), std::strerror(errno));
  }
  if (!S_ISREG(status.st_mode)) return failure(ErrorCode::kUnsupported, "%s: is not a file", path.c_str());
  size_ = static_cast<std::uint64_t>(status.st_size);
  std::string magic;
  TOUCHLINE_TRY_ASSIGN(const bool has_magic, load(0, kMagic.size(), magic));
  if (!has_magic || magic != kMagic) {
    return failure(ErrorCode::kCorruptFrame, "%s: is not a recording (MCAP)", path.c_str());
  }
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

// Returns false if the file ends before.
Result<bool> McapReader::load(std::uint64_t position, std::uint64_t count, std::string& out) const {
  if (position > size_ || count > size_ - position) return false;
  out.resize(static_cast<std::size_t>(count));
  std::size_t done = 0;
  while (done < out.size()) {
    const ssize_t read = ::pread(file_, out.data() + done, out.size() - done, static_cast<off_t>(position + done));
    if (read < 0 && errno == EINTR) continue;
    if (read < 0) return failure(ErrorCode::kIo, "%s: %s", path_.c_str(), std::strerror(errno));
    if (read == 0) return false;  // somebody has cut the file meanwhile
    done += static_cast<std::size_t>(read);
  }
  return true;
}

// Reads the next record of the file into record_, with its header. Returns false if it is not whole.
Result<bool> McapReader::next_record() {
  TOUCHLINE_TRY_ASSIGN(const bool has_header, load(position_, kRecordHeaderBytes, record_));
  if (!has_header) return false;
  RecordReader header(bytes_of(record_));
  static_cast<void>(header.number<std::uint8_t>());
  const auto length = header.number<std::uint64_t>();
  if (length > kMaxRecordBytes) return false;
  return load(position_, kRecordHeaderBytes + length, record_);
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
                   path_.c_str(), compression.c_str());
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
