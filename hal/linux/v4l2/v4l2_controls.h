#pragma once

#include "core/time.h"
#include "hal/device_parameters.h"
#include "hal/error_text.h"
#include "hal/linux/v4l2/v4l2_device.h"

namespace touchline::hal {

/// Sets exposure, gain, white balance, focus and the power line filter as in the settings, and turns off UVC's option
/// to lower the frame rate for long exposures. Reads each value back. Appends to `negotiated` what the camera lacks,
/// refuses or rounds, separated by "; ". Returns the exposure time; zero if the driver does not tell it (automatic, or
/// no such control). The device must be open; it may stream. Any thread may call it.
Duration apply_controls(const V4l2Device& device, const CameraSettings& asked, ErrorText& negotiated);

/// The same while the camera streams, and only for values that differ between `before` and `asked`: each control can
/// take a UVC camera milliseconds or a frame, and writing the focus moves the lens even if the value is the same.
Duration change_controls(const V4l2Device& device, const CameraSettings& before, const CameraSettings& asked,
                         ErrorText& negotiated);

/// Appends the current values: ", exposure 5000 us, gain 64, white balance automatic, ...". Leaves out controls that
/// the camera lacks.
void describe_controls(const V4l2Device& device, ErrorText& text);

}  // namespace touchline::hal
