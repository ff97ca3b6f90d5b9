#pragma once

#include <string>

#include "core/time.h"

namespace touchline::hal {

/// A file of V4L2, closed with the object. Calls answer 0 or an errno.
class V4l2Device {
 public:
  V4l2Device() = default;
  V4l2Device(const V4l2Device&) = delete;
  V4l2Device& operator=(const V4l2Device&) = delete;
  ~V4l2Device() { close(); }

  [[nodiscard]] int open(const std::string& path);
  void close();
  [[nodiscard]] bool is_open() const { return file_ >= 0; }
  [[nodiscard]] int file() const { return file_; }

  /// ioctl(), repeated when a signal came in between.
  [[nodiscard]] int request(unsigned long code, void* argument) const;
  /// 0 when the driver wants to be asked (a frame, or an error that the next request tells), ETIMEDOUT at the deadline.
  [[nodiscard]] int wait(Instant deadline) const;

 private:
  int file_ = -1;
};

/// "/dev/video0 (name, bus) = /dev/v4l/by-path/..., ..." of all cameras that can stream, or "none". Opens every video
/// device: for messages.
std::string cameras_here();

}  // namespace touchline::hal
