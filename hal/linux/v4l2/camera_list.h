#pragma once

#include <string>
#include <vector>

#include "hal/linux/v4l2/v4l2_device.h"

namespace touchline::hal {

// Folders of udev's links to cameras: by socket, and by model and serial number.
inline constexpr const char* kCameraLinks = "/dev/v4l/by-path";
inline constexpr const char* kCameraIdLinks = "/dev/v4l/by-id";

/// A video device that captures and streams, or a video device that cannot be opened.
struct CameraNode {
  std::string path;            // "/dev/video0"
  std::string by_path, by_id;  // links to the device, "" if there is none
  int error = 0;               // errno of open(); then the rest is empty
  V4l2Identity identity;
};

/// Lists all cameras, sorted by number. Opens every video device.
std::vector<CameraNode> list_cameras();

/// Returns the list of list_cameras() as text for messages: "/dev/video0 (name, bus) = /dev/v4l/by-path/..., ..." or
/// "none".
std::string available_cameras();

/// Returns true if a board file names a camera by its number, which can change, instead of by a link.
bool is_numbered_camera(const std::string& device);

}  // namespace touchline::hal
