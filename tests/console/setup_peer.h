#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "hal/linux/network/descriptor.h"

namespace touchline::console {

/// A setup program that sends what the test tells it, on a blocking Unix socket. It shares no code with the firmware. A
/// wait ends after half a minute, which no working test reaches.
class SetupPeer {
 public:
  struct Message {
    nlohmann::json text;  // null: the connection has ended
    std::string binary;
  };

  /// Listens at `path`.
  explicit SetupPeer(std::string path);
  ~SetupPeer();
  SetupPeer(const SetupPeer&) = delete;
  SetupPeer& operator=(const SetupPeer&) = delete;

  /// Waits for the firmware; returns false if it did not connect.
  bool accept();
  void send(std::string_view text, std::string_view binary = {});
  void send_bytes(std::string_view bytes);
  Message read();
  /// Returns the next message of this type; others are skipped.
  Message read_type(std::string_view type);
  /// Ends the connection; accept() waits for the next one.
  void hang_up() { connection_.reset(); }
  /// Ends the connection only in the direction to the firmware.
  void end_sending();
  /// Stops listening.
  void leave();

 private:
  std::string read_bytes(std::size_t size);

  const std::string path_;
  hal::Descriptor listener_, connection_;
};

/// Returns a length as bytes in front of a message: "\x05\0\0\0".
std::string length_bytes(std::uint32_t length);

}  // namespace touchline::console
