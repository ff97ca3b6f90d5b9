#pragma once

#include <libcamera/controls.h>

#include "hal/linux/libcamera/libcamera_link.h"

// Between libcamera's controls and our numbers. Included by libcamera_link.cpp and its tests alone.
namespace touchline::hal {

LibcameraLimits limits_of(const libcamera::ControlInfoMap& of_camera);

/// `external`: at USB, where exposure and gain are automatic or fixed together.
void set_controls(libcamera::ControlList& list, const libcamera::ControlInfoMap& of_camera,
                  const LibcameraNumbers& numbers, bool external);

/// What a completed request's metadata tell.
LibcameraNumbers told_by(const libcamera::ControlList& metadata);

}  // namespace touchline::hal
