#pragma once

#include <cstdint>
#include <string>

#include "core/time.h"

namespace touchline::hal {

/// What a video device says that it is.
struct V4l2Identity {
  std::string driver, card, bus;
  bool captures = false;      // pictures, through one of V4L2's two interfaces
  bool multi_planar = false;  // the one whose pictures may lie in several pieces of memory, and the other is not there
  bool streams = false;       // into buffers that can be mapped
};

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

  /// ioctl(), repeated when a signal came in between. Any thread may call it while the device is open.
  [[nodiscard]] int request(unsigned long code, void* argument) const;
  /// 0 when the driver wants to be asked (a frame, or an error that the next request tells), ETIMEDOUT at the deadline.
  [[nodiscard]] int wait(Instant deadline) const;
  [[nodiscard]] int identify(V4l2Identity& identity) const;

 private:
  int file_ = -1;
};

/// V4L2's number for the queue that captures.
std::uint32_t capture_type(bool multi_planar);

}  // namespace touchline::hal
