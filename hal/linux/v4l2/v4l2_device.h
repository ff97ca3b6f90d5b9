#pragma once

#include <cstdint>
#include <string>

#include "core/time.h"

namespace touchline::hal {

/// Result of VIDIOC_QUERYCAP.
struct V4l2Identity {
  std::string driver, card, bus;
  bool captures = false;      // captures video, single-planar or multi-planar
  bool multi_planar = false;  // captures only by the multi-planar interface
  bool streams = false;       // captures into mapped buffers
};

/// An open V4L2 device, closed by the destructor. Calls return 0 or an errno.
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

  /// Calls ioctl(), repeatedly after EINTR. Any thread may call it while the device is open.
  [[nodiscard]] int request(unsigned long code, void* argument) const;
  /// Waits for a frame or an error; the next request returns it. ETIMEDOUT: the deadline has passed.
  [[nodiscard]] int wait(Instant deadline) const;
  [[nodiscard]] int identify(V4l2Identity& identity) const;

 private:
  int file_ = -1;
};

/// Returns the type of the capture queue in V4L2's requests.
std::uint32_t capture_type(bool multi_planar);

}  // namespace touchline::hal
