#include "hal/linux/v4l2/camera_list.h"

#include <cerrno>
#include <utility>

#include "hal/linux/device_files.h"

namespace touchline::hal {
namespace {

constexpr const char* kCameraFiles = "/dev/video";

}  // namespace

std::vector<CameraNode> list_cameras() {
  std::vector<CameraNode> cameras;
  for (const std::string& path : numbered_files(kCameraFiles)) {
    CameraNode node;
    node.path = path;
    V4l2Device device;
    node.error = device.open(path);
    // Skips files that are not video devices, and devices that have just disappeared.
    if (node.error == 0 && device.identify(node.identity) != 0) continue;
    if (node.error == 0 && !(node.identity.captures && node.identity.streams)) continue;
    node.by_path = stable_link(kCameraLinks, path);
    node.by_id = stable_link(kCameraIdLinks, path);
    cameras.push_back(std::move(node));
  }
  return cameras;
}

std::string available_cameras() {
  std::string list;
  for (const CameraNode& node : list_cameras()) {
    if (node.error != 0 && node.error != EACCES) continue;
    if (!list.empty()) list += ", ";
    list += node.path;
    list += node.error != 0 ? " (permission denied)" : " (" + node.identity.card + ", " + node.identity.bus + ")";
    if (!node.by_path.empty()) list += " = " + node.by_path;
  }
  return list.empty() ? "none" : list;
}

bool is_numbered_camera(const std::string& device) { return is_numbered(device, kCameraFiles); }

}  // namespace touchline::hal
