#pragma once

#include <cstdint>

#include "core/status.h"
#include "core/types.h"
#include "hal/device_parameters.h"
#include "hal/linux/reason.h"
#include "hal/linux/v4l2_device.h"

namespace touchline::hal {

/// How a granted picture lies in a buffer.
struct V4l2Picture {
  PixelFormat format = PixelFormat::kYuyv;
  std::uint16_t width_px = 0, height_px = 0;
  std::uint32_t stride_bytes = 0;
  std::uint32_t needed_bytes = 0;  // a buffer with fewer is a short frame
  bool interlaced = false;         // the two fields are half a frame apart
};

/// Asks for the format and size of `asked`. kUnsupported: the driver has another one; `reason` then lists what it has.
/// kDeviceBusy: somebody else streams.
Result<V4l2Picture> negotiate_format(const V4l2Device& device, const CameraSettings& asked, Reason& reason);

/// Asks for a frame rate. Hz that were granted, 0 when the driver does not tell.
double negotiate_rate(const V4l2Device& device, double asked_hz);

}  // namespace touchline::hal
