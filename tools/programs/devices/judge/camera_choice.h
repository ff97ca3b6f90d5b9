#pragma once

#include <string>
#include <vector>

#include "hal/device_parameters.h"
#include "hal/linux/libcamera/libcamera_link.h"
#include "hal/linux/v4l2/camera_list.h"
#include "hal/linux/v4l2/v4l2_format_list.h"
#include "hal/result.h"

namespace touchline::devices {

/// Reads "mjpg,1280x720,60": format, size and rate, as in board.toml. kInconsistent: the text is malformed; the message
/// says how.
Result<void> parse_mode(const std::string& text, hal::CameraSettings& settings);

/// Chooses the camera that `device` names: the file of a V4L2 device or a link to it, an id of libcamera or a part of
/// one, or "auto". "" selects a camera on a ribbon cable, through libcamera; else the first V4L2 camera that delivers
/// pictures; else the first camera of libcamera. `mode`: as for parse_mode(); "": the mode is chosen. kNotFound: there
/// is no such camera; the message lists the cameras that exist.
Result<hal::CameraSettings> choose_camera(const std::string& device, const std::string& mode);

}  // namespace touchline::devices
