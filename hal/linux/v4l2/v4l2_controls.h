#pragma once

#include "core/time.h"
#include "hal/device_parameters.h"
#include "hal/error_text.h"
#include "hal/linux/v4l2/v4l2_device.h"

namespace touchline::hal {

/// Sets exposure, gain, white balance, focus and the power line filter as in the settings, and turns off UVC's option
/// to lower the frame rate for long exposures. Reads each value back. Appends to `negotiated`, separated by "; ", the
/// controls that are missing, the values that the camera refuses or rounds, and that the camera mirrors the picture.
/// Returns the exposure time; zero if it is unknown (automatic exposure, or no such control). The device must be open;
/// it may stream. Any thread may call it.
Duration apply_controls(const V4l2Device& device, const CameraSettings& requested, ErrorText& negotiated);

/// Sets controls as apply_controls() does while the camera streams, but only those values that differ between `before`
/// and `requested`: each control can cost a UVC camera milliseconds or a frame, and writing the focus moves the lens
/// even if the value is the same.
Duration change_controls(const V4l2Device& device, const CameraSettings& before, const CameraSettings& requested,
                         ErrorText& negotiated);

/// Appends the current values: ", exposure 5000 us, gain 64, white balance automatic, ...". Leaves out controls that
/// the camera lacks.
void describe_controls(const V4l2Device& device, ErrorText& text);

}  // namespace touchline::hal
