#pragma once

#include "hal/device_parameters.h"
#include "hal/error_text.h"
#include "hal/linux/libcamera/libcamera_link.h"

namespace touchline::hal {

/// Units of camera.gain and camera.focus in the board file: hundredths of libcamera's gain factor, and hundredths of a
/// diopter.
inline constexpr double kLibcameraSteps = 100.0;

/// Returns the controls for these settings, limited to the ranges of the camera. Appends controls that the camera lacks
/// to `negotiated`.
LibcameraNumbers controls_for(const CameraSettings& requested, const LibcameraLimits& limits, ErrorText& negotiated);

/// Returns true if a frame was taken with these controls. Values that the frame does not report count as equal.
bool are_in_effect(const LibcameraNumbers& reported, const LibcameraNumbers& controls);

/// Returns `before` with the values that `controls` contains; all other controls keep their values.
LibcameraNumbers adjusted(const LibcameraNumbers& before, const LibcameraNumbers& controls);

/// Appends to `negotiated` the values that differ from the settings by more than the rounding of the sensor (1 %), and
/// those that were set but are not in the frame's metadata.
void report_negotiated(const CameraSettings& requested, const LibcameraLimits& limits, const LibcameraNumbers& controls,
                       const LibcameraNumbers& reported, ErrorText& negotiated);
/// As above without the frame rate, which can be set only at the start.
void report_negotiated_controls(const CameraSettings& requested, const LibcameraLimits& limits,
                                const LibcameraNumbers& controls, const LibcameraNumbers& reported,
                                ErrorText& negotiated);

/// Appends the values that a frame reports, in units of the keys: ", exposure 4970 us, gain 250, ...".
void describe_controls(const LibcameraNumbers& reported, ErrorText& text);

}  // namespace touchline::hal
