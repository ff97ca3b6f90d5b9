#include "firmware/console/setup_link.h"

#include <sys/socket.h>
#include <sys/un.h>
#include <array>
#include <cerrno>
#include <cstring>
#include <memory>
#include <utility>

namespace touchline::console {
namespace {

using namespace std::chrono_literals;

constexpr Duration kConnectPause = 1s;
// If the setup program neither reads nor answers for this time, the connection is closed. Even a busy program reads its
// socket.
constexpr Duration kSilenceLimit = 5s;
constexpr std::size_t kFrameHeaderBytes = 8;
// Enough for several pages on which people drag corners.
constexpr std::size_t kMaxWaitingMessages = 256;
// Limits of one call, so that the console's other clients do not wait. With a call every 8 ms, this still allows more
// than 100 MB/s.
constexpr std::size_t kReadBytes = std::size_t{64} * 1024, kMaxReads = 16;
// The kernel's default of 200 KiB is only a third of a small picture.
constexpr int kSendBufferBytes = 1024 * 1024;

std::uint32_t length_at(std::span<const std::byte> bytes, std::size_t offset) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < sizeof(value); ++i) {
    value |= std::to_integer<std::uint32_t>(bytes[offset + i]) << (8 * i);
  }
  return value;
}

void append_length(std::vector<std::byte>& to, std::size_t length) {
  for (std::size_t i = 0; i < sizeof(std::uint32_t); ++i) to.push_back(static_cast<std::byte>(length >> (8 * i)));
}

// Returns the connected socket; it is not open if the program is not running.
hal::Descriptor connected_to(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof(address.sun_path)) return {};
  std::memcpy(address.sun_path, path.data(), path.size());
  hal::Descriptor descriptor(::socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  if (!descriptor.is_open()) return {};
  ::setsockopt(descriptor.get(), SOL_SOCKET, SO_SNDBUF, &kSendBufferBytes, sizeof(kSendBufferBytes));
  // A Unix socket is connected at once or not at all.
  if (::connect(descriptor.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0) return {};
  return descriptor;
}

}  // namespace

Result<void> SetupLink::serve(Instant now) {
  if (!is_connected() && now >= next_attempt_) connect(now);
  if (!is_connected()) return {};
  if (is_new_) progress_ = now;
  is_new_ = false;
  Result<void> served = write(now);
  if (served.ok()) served = read();
  const bool waits_for_program = is_sending() || !has_answered_;
  if (!waits_for_program) progress_ = now;
  if (served.ok() && now - progress_ > kSilenceLimit) {
    served = failure(ErrorCode::kTimeout, "it does not %s", has_answered_ ? "read its messages" : "answer");
  }
  if (!served.ok()) close(now);
  return served;
}

void SetupLink::connect(Instant now) {
  next_attempt_ = now + kConnectPause;
  if (path_.empty() || std::exchange(is_connecting_, true)) return;
  files_.run([this, path = path_]() -> FileThread::Finish {
    // The socket is in a shared pointer, because a function object must be copyable.
    const auto socket = std::make_shared<hal::Descriptor>(connected_to(path));
    return [this, socket] { begin(std::move(*socket)); };
  });
}

void SetupLink::begin(hal::Descriptor socket) {
  is_connecting_ = false;
  if (!socket.is_open()) return;
  socket_ = std::move(socket);
  is_new_ = true;
  ++connections_;
}

void SetupLink::close(Instant now) {
  socket_.reset();
  next_attempt_ = now + kConnectPause;
  has_answered_ = false;
  input_.clear();
  received_.clear();
  output_.clear();
  written_ = 0;
}

Result<void> SetupLink::write(Instant now) {
  while (!output_.empty()) {
    const std::vector<std::byte>& first = output_.front();
    const ssize_t sent =
        ::send(socket_.get(), first.data() + written_, first.size() - written_, MSG_NOSIGNAL | MSG_DONTWAIT);
    if (sent < 0 && errno == EINTR) continue;
    if (sent < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) return {};
    if (sent < 0) return failure(ErrorCode::kDisconnected, "it has ended");
    progress_ = now;
    written_ += static_cast<std::size_t>(sent);
    if (written_ < first.size()) return {};
    output_.pop_front();
    written_ = 0;
  }
  return {};
}

Result<void> SetupLink::read() {
  std::array<std::byte, kReadBytes> part{};
  for (std::size_t i = 0; i < kMaxReads; ++i) {
    const ssize_t size = ::recv(socket_.get(), part.data(), part.size(), MSG_DONTWAIT);
    if (size < 0 && errno == EINTR) continue;
    if (size < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) return {};
    if (size <= 0) {
      return failure(ErrorCode::kDisconnected, "%s", input_.empty() ? "it has ended" : "it ended within a message");
    }
    input_.insert(input_.end(), part.begin(), part.begin() + size);
    TOUCHLINE_TRY(split());
  }
  return {};
}

Result<void> SetupLink::split() {
  std::size_t begin = 0;
  while (input_.size() - begin >= kFrameHeaderBytes) {
    const std::size_t text = length_at(input_, begin), binary = length_at(input_, begin + 4);
    if (text > kMaxSetupTextBytes || binary > kMaxSetupBinaryBytes) {
      return failure(ErrorCode::kOutOfRange, "its message of %zu and %zu bytes is too long", text, binary);
    }
    const std::size_t end = begin + kFrameHeaderBytes + text + binary;
    if (input_.size() < end) break;
    const std::byte* const from = input_.data() + begin + kFrameHeaderBytes;
    SetupMessage& message = received_.emplace_back();
    message.text.assign(reinterpret_cast<const char*>(from), text);
    message.binary.assign(from + text, from + text + binary);
    begin = end;
    has_answered_ = true;
  }
  input_.erase(input_.begin(), input_.begin() + static_cast<std::ptrdiff_t>(begin));
  return {};
}

std::optional<SetupMessage> SetupLink::receive() {
  if (received_.empty()) return std::nullopt;
  SetupMessage message = std::move(received_.front());
  received_.pop_front();
  return message;
}

bool SetupLink::send(std::string_view text, std::span<const std::byte> binary) {
  if (!is_connected() || output_.size() >= kMaxWaitingMessages) return false;
  std::vector<std::byte>& message = output_.emplace_back();
  message.reserve(kFrameHeaderBytes + text.size() + binary.size());
  append_length(message, text.size());
  append_length(message, binary.size());
  const auto bytes = std::as_bytes(std::span(text));
  message.insert(message.end(), bytes.begin(), bytes.end());
  message.insert(message.end(), binary.begin(), binary.end());
  return true;
}

}  // namespace touchline::console
