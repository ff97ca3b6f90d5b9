#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/time.h"
#include "firmware/console/file_thread.h"
#include "hal/linux/network/descriptor.h"
#include "hal/result.h"

namespace touchline::console {

// Limit of a text; the state of a setup with the differences of the files has about 20 KiB.
inline constexpr std::size_t kMaxSetupTextBytes = std::size_t{256} * 1024;
// Limit of the bytes: an incompressible PNG of the largest camera, 2592 x 1944 pixels of 3 bytes, has 14.4 MiB.
inline constexpr std::size_t kMaxSetupBinaryBytes = std::size_t{16} * 1024 * 1024;

/// A message of the setup program: a text in JSON, and bytes that may follow it.
struct SetupMessage {
  std::string text;
  std::vector<std::byte> binary;
};

/// The connection to the setup program, a Unix stream socket on which each message has the length of its text (u32,
/// little-endian), the length of its bytes, the text, and the bytes. It connects by itself, also after every failure.
/// No call blocks.
class SetupLink {
 public:
  /// `path` "": there is no setup program. `files` checks whether the socket exists, because its folder may be on a
  /// disk; its jobs do not use this object after its end.
  SetupLink(std::string path, FileThread& files) : path_(std::move(path)), files_(files) {}
  ~SetupLink() = default;
  SetupLink(const SetupLink&) = delete;
  SetupLink& operator=(const SetupLink&) = delete;

  /// Connects, writes and reads, as far as possible at the moment. Call it every few milliseconds while something is
  /// exchanged. The error says why the connection has just ended; it is no error if the program does not run.
  Result<void> serve(Instant now);
  /// Returns the next message that has arrived.
  std::optional<SetupMessage> receive();
  /// Returns false if the program does not read or is not connected.
  bool send(std::string_view text, std::span<const std::byte> binary = {});
  /// Ends the connection; serve() opens a new one after a pause.
  void close(Instant now);

  [[nodiscard]] bool is_connected() const { return socket_.is_open(); }
  /// Returns whether the program has sent a message since it was connected.
  [[nodiscard]] bool is_running() const { return is_connected() && has_answered_; }
  [[nodiscard]] bool is_sending() const { return !output_.empty(); }
  /// Returns a number that increases with every connection.
  [[nodiscard]] std::uint64_t connections() const { return connections_; }

 private:
  void connect(Instant now);
  void begin(hal::Descriptor socket);
  Result<void> write(Instant now);
  Result<void> read();
  Result<void> split();

  const std::string path_;
  FileThread& files_;
  bool is_connecting_ = false, is_new_ = false;
  hal::Descriptor socket_;
  Instant next_attempt_{}, progress_{};  // progress_: last time at which the program has read or answered
  bool has_answered_ = false;
  std::uint64_t connections_ = 0;
  std::vector<std::byte> input_;
  std::deque<SetupMessage> received_;
  std::deque<std::vector<std::byte>> output_;
  std::size_t written_ = 0;  // written bytes of the first message
};

}  // namespace touchline::console
