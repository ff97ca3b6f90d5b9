#include "tools/programs/setup/message_link.h"

#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>

#include "hal/linux/system_error.h"

namespace touchline::setup {
namespace {

constexpr std::size_t kHeaderBytes = 8;
// Limit of bytes that wait: a reader this far behind does not read at all. It allows for two of the largest pictures.
constexpr std::size_t kMaxWaitingBytes = 2 * kMaxBinaryBytes;

void append_u32(std::string& out, std::size_t value) {
  for (unsigned shift = 0; shift < 32; shift += 8) out += static_cast<char>(value >> shift & 0xffu);
}

std::size_t u32_at(std::string_view bytes, std::size_t at) {
  std::size_t value = 0;
  for (std::size_t i = 4; i > 0; --i) value = value << 8u | static_cast<unsigned char>(bytes[at + i - 1]);
  return value;
}

}  // namespace

std::string framed(const nlohmann::json& content, std::string_view bytes) {
  const std::string text = content.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  std::string out;
  out.reserve(kHeaderBytes + text.size() + bytes.size());
  append_u32(out, text.size());
  append_u32(out, bytes.size());
  return out.append(text).append(bytes);
}

Result<std::optional<Message>> MessageReader::next() {
  if (buffer_.size() < kHeaderBytes) return std::optional<Message>();
  const std::size_t content = u32_at(buffer_, 0), binary = u32_at(buffer_, 4);
  if (content > kMaxContentBytes || binary > kMaxBinaryBytes) {
    return failure(ErrorCode::kOutOfRange, "a message of %zu + %zu bytes is too long", content, binary);
  }
  if (buffer_.size() < kHeaderBytes + content + binary) return std::optional<Message>();
  Message message;
  message.content =
      nlohmann::json::parse(buffer_.begin() + kHeaderBytes,
                            buffer_.begin() + static_cast<std::ptrdiff_t>(kHeaderBytes + content), nullptr, false);
  message.bytes = buffer_.substr(kHeaderBytes + content, binary);
  buffer_.erase(0, kHeaderBytes + content + binary);
  if (!message.content.is_object()) return Error{ErrorCode::kInconsistent, "a message is not a JSON object"};
  return std::optional(std::move(message));
}

Result<void> MessageLink::send(const nlohmann::json& content, std::string_view bytes) {
  if (!is_open()) return Error{ErrorCode::kIo, "nobody is connected"};
  output_ += framed(content, bytes);
  return flush();
}

Result<void> MessageLink::flush() {
  std::size_t sent = 0;
  while (sent < output_.size()) {
    const ssize_t count = ::send(descriptor(), output_.data() + sent, output_.size() - sent, MSG_NOSIGNAL);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0 && errno == EAGAIN) break;
    if (count < 0) {
      const int error = errno;
      close();
      return failure(ErrorCode::kIo, "sending failed: %s", hal::system_text(error));
    }
    sent += static_cast<std::size_t>(count);
  }
  output_.erase(0, sent);
  if (output_.size() <= kMaxWaitingBytes) return {};
  close();
  return Error{ErrorCode::kIo, "the other side reads nothing"};
}

Result<void> MessageLink::receive() {
  std::array<char, 65536> part{};
  // Limited, so that messages are handled in between and a fast sender does not fill the memory.
  constexpr int kMaxPartsAtOnce = 64;
  for (int i = 0; i < kMaxPartsAtOnce; ++i) {
    const ssize_t count = ::read(descriptor(), part.data(), part.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0 && errno == EAGAIN) return {};
    if (count <= 0) {
      const int error = errno;
      // Messages that have already arrived can still be read.
      const hal::Descriptor gone = std::move(descriptor_);
      ::shutdown(gone.get(), SHUT_RDWR);
      return failure(ErrorCode::kIo, "%s", count == 0 ? "the other side has closed" : hal::system_text(error));
    }
    reader_.append({part.data(), static_cast<std::size_t>(count)});
    if (static_cast<std::size_t>(count) < part.size()) break;
  }
  return {};
}

Result<std::optional<Message>> MessageLink::next() {
  Result<std::optional<Message>> message = reader_.next();
  if (!message.ok()) close();
  return message;
}

void MessageLink::close() {
  // Shut down the connection: a worker has copies of the program's descriptors, so closing alone does not end it.
  if (is_open()) ::shutdown(descriptor(), SHUT_RDWR);
  *this = MessageLink();
}

}  // namespace touchline::setup
