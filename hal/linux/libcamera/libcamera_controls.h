#pragma once

#include "hal/device_parameters.h"
#include "hal/error_text.h"
#include "hal/linux/libcamera/libcamera_link.h"

namespace touchline::hal {

/// Units of `gain` and `focus` in the board file: hundredths of libcamera's factor and of a dioptre.
inline constexpr double kLibcameraSteps = 100.0;

/// What to tell a camera so that it does as the settings say, within its limits. A control that it lacks is appended to
/// `negotiated`.
LibcameraNumbers controls_for(const CameraSettings& asked, const LibcameraLimits& limits, ErrorText& negotiated);

/// Whether a frame was taken with these controls; what the frame does not tell is taken to be so.
bool is_taken_with(const LibcameraNumbers& reported, const LibcameraNumbers& controls);

/// What is reported a camera that was reported `before`: what the settings leave alone stays as it is.
LibcameraNumbers adjusted(const LibcameraNumbers& before, const LibcameraNumbers& controls);

/// Appends to `negotiated` what differs from the settings by more than the sensor's rounding (1 %), and what was set
/// but is not reported by a frame.
void report_negotiated(const CameraSettings& asked, const LibcameraLimits& limits, const LibcameraNumbers& controls,
                       const LibcameraNumbers& reported, ErrorText& negotiated);
/// The same without the rate, which only a start sets.
void report_negotiated_controls(const CameraSettings& asked, const LibcameraLimits& limits,
                                const LibcameraNumbers& controls, const LibcameraNumbers& reported,
                                ErrorText& negotiated);

/// Appends ", exposure 4970 us, gain 250, ..." of what a frame tells, in the keys' units.
void describe_controls(const LibcameraNumbers& reported, ErrorText& text);

}  // namespace touchline::hal
