#pragma once

#include "core/time.h"
#include "hal/device_parameters.h"
#include "hal/error_text.h"
#include "hal/linux/v4l2/v4l2_device.h"

namespace touchline::hal {

/// Fixes exposure, gain, white balance, focus and lamp flicker as the settings say, and that the rate comes before the
/// exposure where that is automatic; reads each back. What the camera lacks, refuses or rounds is appended to
/// `negotiated`, each with "; " before it where something stands there already. Returns the exposure time in force,
/// zero when it is the driver's secret (automatic, or no such control). Works on an open device whether it streams or
/// not, and on any thread: nothing but `negotiated` is written to.
Duration apply_controls(const V4l2Device& device, const CameraSettings& asked, ErrorText& negotiated);

/// The same for a stream under way, and only for what `asked` has otherwise than `before`: a UVC camera may take
/// milliseconds for each control, or drop a frame, and moves its lens even where it stands already.
Duration change_controls(const V4l2Device& device, const CameraSettings& before, const CameraSettings& asked,
                         ErrorText& negotiated);

/// Appends what is in force: ", exposure 5000 us, gain 64, white balance automatic, ..."; controls that the camera
/// lacks are left out.
void describe_controls(const V4l2Device& device, ErrorText& text);

}  // namespace touchline::hal
