#pragma once

#include <sys/types.h>
#include <string>

#include "hal/linux/network/descriptor.h"
#include "hal/result.h"

namespace touchline::hal {

/// A unix stream socket that other programs connect to. A stream is used instead of datagrams, because the other
/// program then needs no socket file, several programs can connect, and a line is a message: Python reads it with `for
/// line in socket.makefile()`.
class UnixListener {
 public:
  UnixListener() = default;
  ~UnixListener() { close(); }
  UnixListener(const UnixListener&) = delete;
  UnixListener& operator=(const UnixListener&) = delete;
  /// Makes the socket file. A socket of this user to which nobody listens was left by a dead process and is replaced;
  /// any other file stays and is an error.
  Result<void> open(const std::string& path);
  /// Returns the connection of a program that has connected; if there is none, the descriptor is not open.
  [[nodiscard]] Descriptor accept() const;
  /// Removes the socket file if it still belongs to this listener.
  void close();
  [[nodiscard]] int descriptor() const { return socket_.get(); }

 private:
  std::string path_;
  Descriptor socket_;
  dev_t device_ = 0;  // identify the socket file
  ino_t inode_ = 0;
};

}  // namespace touchline::hal
