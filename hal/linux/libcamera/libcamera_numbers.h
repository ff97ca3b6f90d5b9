#pragma once

#include <libcamera/controls.h>

#include "hal/linux/libcamera/libcamera_link.h"

// Converts libcamera's controls to numbers and back. Only libcamera_link.cpp and its tests include this file.
namespace touchline::hal {

LibcameraLimits limits_of(const libcamera::ControlInfoMap& of_camera);

/// `external`: a USB camera, whose exposure and gain can only be automatic or fixed together.
void set_controls(libcamera::ControlList& list, const libcamera::ControlInfoMap& of_camera,
                  const LibcameraNumbers& numbers, bool external);

/// Returns the values in the metadata of a completed request.
LibcameraNumbers reported_by(const libcamera::ControlList& metadata);

}  // namespace touchline::hal
