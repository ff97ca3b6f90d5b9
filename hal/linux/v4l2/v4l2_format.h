#pragma once

#include <array>
#include <cstdint>

#include "core/status.h"
#include "core/types.h"
#include "hal/device_parameters.h"
#include "hal/error_text.h"
#include "hal/linux/v4l2/v4l2_device.h"
#include "hal/result.h"

namespace touchline::hal {

/// Layout of a picture in a buffer.
struct V4l2Picture {
  CameraFormat format = CameraFormat::kYuyv;
  std::uint16_t width_px = 0, height_px = 0;
  bool multi_planar = false;
  std::uint8_t planes = 1;                               // number of memory planes
  std::array<std::uint32_t, kMaxPlanes> stride_bytes{};  // for each color plane; 0 for JPEG
  std::array<std::uint32_t, kMaxPlanes> needed_bytes{};  // for each memory plane; a frame with fewer bytes is short
  bool interlaced = false;                               // the frame has two fields, half a frame apart in time
  bool full_range = false;                               // for YUV: black is luma 0 instead of 16
};

/// Sets format and size; formats with several color planes may use one memory plane or several. kUnsupported: the
/// driver set another format or size; the message lists the available ones. kDeviceBusy: another process streams.
Result<V4l2Picture> negotiate_format(const V4l2Device& device, bool multi_planar, const CameraSettings& requested);

/// Sets the frame rate. Returns the rate in Hz that the driver chose; 0 if the driver does not report it.
double negotiate_rate(const V4l2Device& device, bool multi_planar, double requested_hz);

}  // namespace touchline::hal
