#pragma once

#include "hal/device_parameters.h"
#include "hal/error_text.h"
#include "hal/linux/libcamera/libcamera_link.h"

namespace touchline::hal {

/// Units of `gain` and `focus` in the board file: hundredths of libcamera's factor and of a dioptre.
inline constexpr double kLibcameraSteps = 100.0;

/// Returns the controls for these settings, limited to the ranges of the camera. Appends the controls that it lacks to
/// `negotiated`.
LibcameraNumbers controls_for(const CameraSettings& asked, const LibcameraLimits& limits, ErrorText& negotiated);

/// True if a frame was taken with these controls. Values that the frame does not report count as equal.
bool is_taken_with(const LibcameraNumbers& reported, const LibcameraNumbers& controls);

/// What is reported a camera that was reported `before`: what the settings leave alone stays as it is.
LibcameraNumbers adjusted(const LibcameraNumbers& before, const LibcameraNumbers& controls);

/// Appends to `negotiated` the values that differ from the settings by more than the rounding of the sensor (1 %), and
/// those that were set but that no frame reports.
void report_negotiated(const CameraSettings& asked, const LibcameraLimits& limits, const LibcameraNumbers& controls,
                       const LibcameraNumbers& reported, ErrorText& negotiated);
/// The same without the rate, which can only be set at the start.
void report_negotiated_controls(const CameraSettings& asked, const LibcameraLimits& limits,
                                const LibcameraNumbers& controls, const LibcameraNumbers& reported,
                                ErrorText& negotiated);

/// Appends ", exposure 4970 us, gain 250, ..." of what a frame tells, in the keys' units.
void describe_controls(const LibcameraNumbers& reported, ErrorText& text);

}  // namespace touchline::hal
