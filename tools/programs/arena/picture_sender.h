#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "hal/linux/network/descriptor.h"
#include "hal/linux/network/picture_stream.h"
#include "hal/linux/network/tcp_socket.h"
#include "hal/result.h"

namespace touchline::arena {

/// Sends pictures to one receiver by TCP (hal/linux/network/picture_stream.h). A new connection takes the place of the
/// former one, because a receiver whose cable was pulled connects again before its first connection ends. Receivers
/// that come and go are printed.
class PictureSender {
 public:
  /// Listens. Errors of hal::listen_tcp().
  Result<void> open(const hal::TcpAddress& address, const hal::StreamHello& hello);

  /// Takes a new connection, if there is one within `patience_ms`.
  void accept(int patience_ms);
  [[nodiscard]] bool is_connected() const { return receiver_.is_open(); }
  /// Waits in lock-step until the receiver asks for a picture. Returns false if it did not within `patience_ms`, or if
  /// it has gone.
  bool wait_for_request(int patience_ms);
  /// Sends a whole picture. The receiver is dropped if it takes nothing for a second. Does nothing without a receiver.
  void send(const hal::PictureHeader& header, std::span<const std::byte> picture);

 private:
  bool send_all(std::span<const std::byte> bytes);
  void drop(const char* why);

  hal::StreamHello hello_;
  hal::Descriptor listener_, receiver_;
};

}  // namespace touchline::arena
