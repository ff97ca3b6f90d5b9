#pragma once

#include <string>
#include <vector>

#include "hal/device_parameters.h"
#include "hal/linux/libcamera/libcamera_link.h"
#include "hal/linux/v4l2/camera_list.h"
#include "hal/linux/v4l2/v4l2_format_list.h"
#include "hal/result.h"

namespace touchline::devices {

/// Reads "mjpg,1280x720,60": format, size and rate of board.toml. kInconsistent: what is wrong with it.
Result<void> parse_mode(const std::string& text, hal::CameraSettings& settings);

/// The camera that `device` names: a V4L2 device, by its file or a link to it, or an id of libcamera, a part of one, or
/// "auto". "": a camera on a ribbon cable, through libcamera; else the first V4L2 camera that
/// delivers pictures; else the first one of libcamera. `mode`: as for
/// parse_mode(), or "": chosen. kNotFound: there is no such camera; the message lists those that there are.
Result<hal::CameraSettings> choose_camera(const std::string& device, const std::string& mode);

}  // namespace touchline::devices
