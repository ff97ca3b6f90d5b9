#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "hal/linux/network/descriptor.h"
#include "hal/result.h"

// Format of the messages between firmware and touchline-setup, and between touchline-setup and its worker: u32 length
// of the JSON, u32 length of the binary part (both little-endian), the JSON object, the binary part.
namespace touchline::setup {

struct Message {
  nlohmann::json content;
  std::string bytes;
};

/// Limit for an exported setup with its pictures; a client that sends more is faulty.
inline constexpr std::size_t kMaxContentBytes = std::size_t{1} << 20;
/// Limit for the largest frame: 2592 x 1944 pixels of 4 bytes.
inline constexpr std::size_t kMaxBinaryBytes = std::size_t{24} << 20;

/// Makes one message. Text that is not UTF-8 is replaced by U+FFFD.
std::string framed(const nlohmann::json& content, std::string_view bytes = {});

/// Cuts a stream of bytes into messages.
class MessageReader {
 public:
  void append(std::string_view bytes) { buffer_.append(bytes); }
  /// Returns the next complete message; empty if more bytes are needed. kOutOfRange: the message is too long;
  /// kInconsistent: it is not a JSON object. After an error the stream cannot be read further.
  Result<std::optional<Message>> next();

 private:
  std::string buffer_;
};

/// One end of a connection that never blocks: bytes that the other side does not take yet are kept, up to a limit.
class MessageLink {
 public:
  MessageLink() = default;
  explicit MessageLink(hal::Descriptor descriptor) : descriptor_(std::move(descriptor)) {}

  [[nodiscard]] bool is_open() const { return descriptor_.is_open(); }
  [[nodiscard]] int descriptor() const { return descriptor_.get(); }
  [[nodiscard]] bool has_output() const { return !output_.empty(); }
  /// Queues a message and sends what fits. kIo: the other side is gone, or reads nothing; the link is closed then.
  Result<void> send(const nlohmann::json& content, std::string_view bytes = {});
  /// Sends as much as the connection takes. kIo as above.
  Result<void> flush();
  /// Reads the bytes that have arrived. kIo: the other side has closed the connection; the link is closed then.
  Result<void> receive();
  /// As MessageReader::next(); closes the link on an error.
  Result<std::optional<Message>> next();
  void close();

 private:
  hal::Descriptor descriptor_;
  MessageReader reader_;
  std::string output_;
};

}  // namespace touchline::setup
