#pragma once

#include <optional>
#include <string>
#include <vector>

#include "firmware/device_list/device_list.h"
#include "hal/device_parameters.h"

namespace touchline::devices {

/// Returns the format that a word of board files means; empty if there is none.
std::optional<hal::CameraFormat> format_of(const std::string& word);

/// Chooses format, size and rate as for a game: the highest rate up to 60 Hz, then the largest picture up to 1280 x
/// 1024, then pictures that are not compressed. Returns false if the camera offers no format that Touchline reads.
bool choose_mode(const std::vector<hal::V4l2FormatInfo>& formats, hal::CameraSettings& settings);

/// Returns the device and mode with which a camera is tried first. Returns nothing if it cannot be opened or offers no
/// format that Touchline reads.
std::optional<hal::CameraSettings> suggested_settings(const Camera& camera);

/// Returns the name for a board file: the link that stays the same if devices are plugged in in another order, or else
/// the path.
std::string lasting_name(const hal::CameraNode& camera);
std::string lasting_name(const hal::SerialPortNode& port);

}  // namespace touchline::devices
