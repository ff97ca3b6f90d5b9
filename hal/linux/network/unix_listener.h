#pragma once

#include <sys/types.h>
#include <string>

#include "hal/linux/network/descriptor.h"
#include "hal/result.h"

namespace touchline::hal {

/// A unix stream socket that other programs connect to. A stream instead of datagrams: the program on the other side
/// needs no socket file of its own, several can connect, and a line is a message, so Python reads it with
/// `for line in socket.makefile()`.
class UnixListener {
 public:
  UnixListener() = default;
  ~UnixListener() { close(); }
  UnixListener(const UnixListener&) = delete;
  UnixListener& operator=(const UnixListener&) = delete;
  /// Makes the socket file. A socket of this user to which nobody listens is left from a dead process and is replaced;
  /// any other file stays and is an error.
  Result<void> open(const std::string& path);
  /// Returns the connection of a program that has connected; if there is none, the descriptor is not open.
  [[nodiscard]] Descriptor accept() const;
  /// Removes the socket file if it is still this listener's.
  void close();
  [[nodiscard]] int descriptor() const { return socket_.get(); }

 private:
  std::string path_;
  Descriptor socket_;
  dev_t device_ = 0;  // of the socket file
  ino_t inode_ = 0;
};

}  // namespace touchline::hal
