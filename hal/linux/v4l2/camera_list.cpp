#include "hal/linux/v4l2/camera_list.h"

#include <cerrno>
#include <utility>

#include "hal/linux/device_files.h"

namespace touchline::hal {
namespace {

constexpr const char* kCameraFiles = "/dev/video";

}  // namespace

std::vector<std::string> camera_files() { return numbered_files(kCameraFiles); }

CameraNode unopened_camera(const std::string& path) {
  CameraNode node;
  node.path = path;
  node.by_path = stable_link(kCameraLinks, path);
  node.by_id = stable_link(kCameraIdLinks, path);
  return node;
}

std::optional<CameraNode> camera_at(const std::string& path) {
  CameraNode node = unopened_camera(path);
  V4l2Device device;
  node.error = device.open(path);
  if (node.error == 0 && device.identify(node.identity) != 0) return std::nullopt;
  if (node.error == 0 && !(node.identity.captures && node.identity.streams)) return std::nullopt;
  return node;
}

std::vector<CameraNode> list_cameras() {
  std::vector<CameraNode> cameras;
  for (const std::string& path : camera_files()) {
    if (std::optional<CameraNode> node = camera_at(path)) cameras.push_back(std::move(*node));
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
