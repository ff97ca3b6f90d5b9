#pragma once

#include <optional>
#include <string>

#include "firmware/device_list/device_list.h"
#include "hal/device_parameters.h"

namespace touchline::devices {

/// Device, format, size and rate with which a camera is tried first: the size closest to 640 x 480, of that the highest
/// rate, and with equal rates raw pictures rather than JPEG. Nothing if it cannot be opened or offers no format that
/// Touchline reads.
std::optional<hal::CameraSettings> suggested_settings(const Camera& camera);

/// The name for a board file: the link that lasts when devices are plugged in in another order, or else the path.
std::string lasting_name(const hal::CameraNode& camera);
std::string lasting_name(const hal::SerialPortNode& port);

}  // namespace touchline::devices
