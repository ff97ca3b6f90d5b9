#include "hal/linux/serial/terminal.h"

#include <fcntl.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <cerrno>

namespace touchline::hal::terminal {

int open_raw(const char* path) {
  // Without O_NONBLOCK, opening a Bluetooth port would wait for the connection.
  const int file = ::open(path, O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (file < 0) return -errno;
  termios line{};
  const bool is_terminal = ::tcgetattr(file, &line) == 0;
  if (is_terminal) {
    ::cfmakeraw(&line);
    line.c_cflag |= CLOCAL | CREAD;
    // read() then returns 0 only if the other side is gone.
    line.c_cc[VMIN] = 1;
    line.c_cc[VTIME] = 0;
  }
  if (is_terminal && ::tcsetattr(file, TCSANOW, &line) == 0 && ::tcflush(file, TCIOFLUSH) == 0) return file;
  const int error = is_terminal ? errno : ENOTTY;
  ::close(file);
  return -error;
}

int write(int file, std::span<const std::byte> bytes) {
  const ssize_t count = ::write(file, bytes.data(), bytes.size());
  if (count >= 0) return static_cast<int>(count);
  return errno == EAGAIN || errno == EINTR ? 0 : -errno;
}

int read(int file, std::span<std::byte> into) {
  if (into.empty()) return 0;
  const ssize_t count = ::read(file, into.data(), into.size());
  if (count > 0) return static_cast<int>(count);
  if (count == 0) return -EIO;
  return errno == EAGAIN || errno == EINTR ? 0 : -errno;
}

int output_waiting(int file) {
  int bytes = 0;
  return ::ioctl(file, TIOCOUTQ, &bytes) == 0 ? bytes : -errno;
}

void close(int file) {
  // A pseudo terminal stays exclusive after it is closed.
  static_cast<void>(::ioctl(file, TIOCNXCL));
  static_cast<void>(::tcflush(file, TCOFLUSH));
  ::close(file);
}

}  // namespace touchline::hal::terminal
