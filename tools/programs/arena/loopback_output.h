#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "hal/device_parameters.h"
#include "hal/linux/network/descriptor.h"
#include "hal/result.h"

namespace touchline::arena {

/// Writes pictures into a device of the kernel module v4l2loopback, which another program opens as a V4L2 camera.
class LoopbackOutput {
 public:
  /// `camera`: format, size and rate of the pictures. kNotFound: there is no such device; kUnsupported: it takes no
  /// pictures, or not of this format. Messages name the device and what to do.
  Result<void> open(const std::string& device, const hal::CameraSettings& camera);
  [[nodiscard]] bool is_open() const { return file_.is_open(); }
  /// Writes a picture; an error ends the output.
  Result<void> write(std::span<const std::byte> picture);

 private:
  std::string device_;
  hal::Descriptor file_;
};

}  // namespace touchline::arena
