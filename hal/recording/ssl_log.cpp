#include "hal/recording/ssl_log.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <concepts>
#include <cstring>

namespace touchline::hal {
namespace {

constexpr std::string_view kMagic = "SSL_LOG_FILE", kGzipMagic = "\x1f\x8b";
constexpr std::int32_t kVersion = 1;
constexpr std::size_t kHeaderBytes = kMagic.size() + sizeof(kVersion);
constexpr std::size_t kMessageHeaderBytes = sizeof(std::int64_t) + 2 * sizeof(std::int32_t);
// Datagrams have up to 64 KB. The index of an hour with four cameras at 100 Hz has 12 MB.
constexpr std::int32_t kMaxMessageBytes = 1 << 26;
// The same as of gzip files for zlib: 15 bits of window, plus 16 for gzip's header.
constexpr int kGzipWindow = 15 + 16;
constexpr int kMemoryLevel = 8;  // zlib's default

template <std::unsigned_integral T>
std::array<std::byte, sizeof(T)> big_endian(T value) {
  std::array<std::byte, sizeof(T)> bytes;
  for (std::size_t i = 0; i < sizeof(T); ++i) bytes[i] = static_cast<std::byte>(value >> (8 * (sizeof(T) - 1 - i)));
  return bytes;
}

template <std::unsigned_integral T>
T from_big_endian(const std::byte* bytes) {
  T value = 0;
  for (std::size_t i = 0; i < sizeof(T); ++i) value = static_cast<T>(value << 8) | std::to_integer<T>(bytes[i]);
  return value;
}

std::int32_t int32_at(const std::byte* bytes) {
  return static_cast<std::int32_t>(from_big_endian<std::uint32_t>(bytes));
}

}  // namespace

bool is_ssl_log(std::string_view first_bytes) {
  return first_bytes.starts_with(kMagic) || first_bytes.starts_with(kGzipMagic);
}

SslLogReader::~SslLogReader() {
  if (file_ != nullptr) ::gzclose_r(file_);
}

Error SslLogReader::error_at(ErrorCode code, const std::string& what) const {
  return failure(code, "%s: byte %llu: %s", path_.c_str(), static_cast<unsigned long long>(position_), what.c_str());
}

Result<void> SslLogReader::open(const std::string& path) {
  path_ = path;
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  struct stat status {};
  if (file < 0 || ::fstat(file, &status) != 0) {
    const ErrorCode code = errno == ENOENT || errno == ENOTDIR ? ErrorCode::kNotFound
                           : errno == EACCES                   ? ErrorCode::kPermission
                                                               : ErrorCode::kIo;
    return failure(code, "%s: cannot be opened: %s", path.c_str(), std::strerror(errno));
  }
  if (!S_ISREG(status.st_mode)) {
    ::close(file);
    return failure(ErrorCode::kUnsupported, "%s: is not a file", path.c_str());
  }
  file_ = ::gzdopen(file, "rb");
  if (file_ == nullptr) {
    ::close(file);
    return failure(ErrorCode::kFull, "%s: not enough memory", path.c_str());
  }
  return read_header();
}

Result<void> SslLogReader::rewind() {
  if (::gzrewind(file_) != 0) return failure(ErrorCode::kIo, "%s: cannot be read again", path_.c_str());
  return read_header();
}

Result<void> SslLogReader::read_header() {
  position_ = 0;
  is_complete_ = false;
  std::array<std::byte, kHeaderBytes> header{};
  TOUCHLINE_TRY_ASSIGN(const std::size_t read, load(header.data(), header.size()));
  if (read < header.size() || std::memcmp(header.data(), kMagic.data(), kMagic.size()) != 0) {
    return error_at(ErrorCode::kCorruptFrame, "is not a game log (SSL_LOG_FILE)");
  }
  const std::int32_t version = int32_at(header.data() + kMagic.size());
  if (version != kVersion) {
    return error_at(ErrorCode::kUnsupported, "the game log has version " + std::to_string(version) + " instead of 1");
  }
  position_ = kHeaderBytes;
  return {};
}

Result<std::size_t> SslLogReader::load(std::byte* to, std::size_t count) {
  const int read = ::gzread(file_, to, static_cast<unsigned>(count));
  int error = Z_OK;
  const char* const text = ::gzerror(file_, &error);
  // A packed file that was cut off has what it has.
  if (read < 0 && error != Z_BUF_ERROR) {
    return error_at(error == Z_ERRNO ? ErrorCode::kIo : ErrorCode::kCorruptFrame,
                    std::string("cannot be read: ") + (error == Z_ERRNO ? std::strerror(errno) : text));
  }
  return static_cast<std::size_t>(read < 0 ? 0 : read);
}

Result<std::optional<SslLogMessage>> SslLogReader::next() {
  std::array<std::byte, kMessageHeaderBytes> header{};
  TOUCHLINE_TRY_ASSIGN(const std::size_t read, load(header.data(), header.size()));
  int error = Z_OK;
  static_cast<void>(::gzerror(file_, &error));
  is_complete_ = read == 0 && error == Z_OK;
  if (read < header.size()) return std::optional<SslLogMessage>();
  SslLogMessage message;
  message.time_ns = static_cast<std::int64_t>(from_big_endian<std::uint64_t>(header.data()));
  message.type = int32_at(header.data() + sizeof(std::int64_t));
  const std::int32_t bytes = int32_at(header.data() + sizeof(std::int64_t) + sizeof(std::int32_t));
  if (bytes < 0 || bytes > kMaxMessageBytes) {
    return error_at(ErrorCode::kCorruptFrame, "a message of " + std::to_string(bytes) + " bytes; the file is damaged");
  }
  data_.resize(static_cast<std::size_t>(bytes));
  auto* const data = reinterpret_cast<std::byte*>(data_.data());
  TOUCHLINE_TRY_ASSIGN(const std::size_t loaded, load(data, data_.size()));
  if (loaded < data_.size()) return std::optional<SslLogMessage>();
  message.data = {data, data_.size()};
  position_ += kMessageHeaderBytes + data_.size();
  return std::optional(message);
}

SslLogWriter::~SslLogWriter() {
  if (is_packed_) ::deflateEnd(&packer_);
}

Result<void> SslLogWriter::open(const std::string& path) {
  TOUCHLINE_TRY(file_.open(path));
  if (path.ends_with(".gz")) {
    if (::deflateInit2(&packer_, Z_DEFAULT_COMPRESSION, Z_DEFLATED, kGzipWindow, kMemoryLevel, Z_DEFAULT_STRATEGY) !=
        Z_OK) {
      return failure(ErrorCode::kFull, "%s: not enough memory", path.c_str());
    }
    is_packed_ = true;
  }
  TOUCHLINE_TRY(write(std::as_bytes(std::span(kMagic))));
  return write(big_endian(static_cast<std::uint32_t>(kVersion)));
}

Result<void> SslLogWriter::add(const SslLogMessage& message) {
  TOUCHLINE_TRY(write(big_endian(static_cast<std::uint64_t>(message.time_ns))));
  TOUCHLINE_TRY(write(big_endian(static_cast<std::uint32_t>(message.type))));
  TOUCHLINE_TRY(write(big_endian(static_cast<std::uint32_t>(message.data.size()))));
  return write(message.data);
}

Result<void> SslLogWriter::commit() {
  if (is_packed_) TOUCHLINE_TRY(pack({}, true));
  return file_.commit();
}

Result<void> SslLogWriter::write(std::span<const std::byte> bytes) {
  if (is_packed_) return pack(bytes, false);
  return file_.write({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

Result<void> SslLogWriter::pack(std::span<const std::byte> bytes, bool is_last) {
  // zlib does not change its input.
  packer_.next_in = reinterpret_cast<Bytef*>(const_cast<std::byte*>(bytes.data()));
  packer_.avail_in = static_cast<uInt>(bytes.size());
  std::array<char, 1 << 14> out;
  do {
    packer_.next_out = reinterpret_cast<Bytef*>(out.data());
    packer_.avail_out = static_cast<uInt>(out.size());
    ::deflate(&packer_, is_last ? Z_FINISH : Z_NO_FLUSH);
    TOUCHLINE_TRY(file_.write({out.data(), out.size() - packer_.avail_out}));
  } while (packer_.avail_out == 0);
  return {};
}

}  // namespace touchline::hal
