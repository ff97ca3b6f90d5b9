#pragma once

#include "core/time.h"
#include "hal/device_parameters.h"
#include "hal/linux/reason.h"
#include "hal/linux/v4l2_device.h"

namespace touchline::hal {

/// Fixes exposure, gain, white balance and lamp flicker as the settings say, and reads each back. What the camera
/// lacks, refuses or rounds is appended to `grants`, each with "; " before it where something stands there already.
/// Returns the exposure time in force, zero when it is the driver's secret (automatic, or no such control).
Duration apply_controls(const V4l2Device& device, const CameraSettings& asked, Reason& grants);

}  // namespace touchline::hal
