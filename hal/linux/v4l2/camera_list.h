#pragma once

#include <string>
#include <vector>

#include "hal/linux/v4l2/v4l2_device.h"

namespace touchline::hal {

// Where udev keeps links to cameras, by the socket they are in and by what they are.
inline constexpr const char* kCameraLinks = "/dev/v4l/by-path";
inline constexpr const char* kCameraIdLinks = "/dev/v4l/by-id";

/// A video device that captures and streams, or one that cannot be asked.
struct CameraNode {
  std::string path;            // "/dev/video0"
  std::string by_path, by_id;  // links to it, "" where there is none
  int error = 0;               // errno of opening it; the rest is empty then
  V4l2Identity identity;
};

/// All of them, by number. Opens every video device.
std::vector<CameraNode> list_cameras();

/// "/dev/video0 (name, bus) = /dev/v4l/by-path/..., ..." of list_cameras(), or "none": for messages.
std::string cameras_here();

/// Whether a board file names a camera by a number, which changes, and not by a link.
bool is_numbered_camera(const std::string& device);

}  // namespace touchline::hal
