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

/// How a granted picture lies in a buffer.
struct V4l2Picture {
  CameraFormat format = CameraFormat::kYuyv;
  std::uint16_t width_px = 0, height_px = 0;
  bool multi_planar = false;
  std::uint8_t planes = 1;                               // pieces of memory
  std::array<std::uint32_t, kMaxPlanes> stride_bytes{};  // of the picture's planes; JPEG has none
  std::array<std::uint32_t, kMaxPlanes> needed_bytes{};  // with fewer in a piece of memory it is a short frame
  bool interlaced = false;                               // the two fields are half a frame apart
  bool full_range = false;                               // YUV whose luma begins at 0 and not at 16
};

/// Asks for the format and size of `asked`; NV12 in one piece of memory or in two. kUnsupported: the driver set
/// another one; the message lists the available ones. kDeviceBusy: another process streams.
Result<V4l2Picture> negotiate_format(const V4l2Device& device, bool multi_planar, const CameraSettings& asked);

/// Asks for a frame rate. Hz that were granted, 0 when the driver does not tell.
double negotiate_rate(const V4l2Device& device, bool multi_planar, double asked_hz);

}  // namespace touchline::hal
