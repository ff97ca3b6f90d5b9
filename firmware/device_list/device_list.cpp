#include "firmware/device_list/device_list.h"

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <memory>
#include <utility>

#include "hal/linux/system_error.h"

namespace touchline::devices {
namespace {

/// Keeps only the devices that `wanted` names ("": all) and records those that are missing or cannot be opened.
template <class Node, class PathOf, class ErrorOf>
void select(std::vector<Node>& nodes, const std::string& wanted, const char* kind, std::vector<std::string>& errors,
            PathOf path_of, ErrorOf error_of) {
  if (wanted.empty()) return;
  const std::unique_ptr<char, decltype(&std::free)> real(::realpath(wanted.c_str(), nullptr), &std::free);
  const std::string path = real != nullptr ? real.get() : wanted;
  std::string here;
  for (const Node& node : nodes) here += (here.empty() ? "" : ", ") + path_of(node);
  nodes.erase(std::remove_if(nodes.begin(), nodes.end(), [&](const Node& node) { return path_of(node) != path; }),
              nodes.end());
  if (nodes.empty()) {
    errors.push_back(wanted + ": no such " + kind + "; here: " + (here.empty() ? "none" : here));
  } else if (std::string error = error_of(nodes.front()); !error.empty()) {
    errors.push_back(std::move(error));
  }
}

Camera query(hal::CameraNode node) {
  Camera camera;
  hal::V4l2Device device;
  if (node.error == 0 && device.open(node.path) == 0) {
    camera.formats = hal::list_formats(device, node.identity.multi_planar, true);
    camera.controls = hal::list_controls(device);
  }
  camera.node = std::move(node);
  return camera;
}

}  // namespace

std::optional<Camera> query_camera(const std::string& path) {
  std::optional<hal::CameraNode> node = hal::camera_at(path);
  if (!node) return std::nullopt;
  return query(std::move(*node));
}

DeviceList list_devices(const Selection& selection) {
  DeviceList list;
  if (selection.camera) {
    std::vector<hal::CameraNode> nodes = hal::list_cameras();
    select(
        nodes, *selection.camera, "camera", list.errors, [](const hal::CameraNode& node) { return node.path; },
        [](const hal::CameraNode& node) { return hal::open_error_text(node.path, node.error, "video"); });
    std::vector<Camera>& cameras = list.cameras.emplace();
    for (hal::CameraNode& node : nodes) cameras.push_back(query(std::move(node)));
  }
  if (selection.libcamera) list.libcamera = hal::libcamera_offers(hal::make_libcamera_link().get());
  if (selection.serial) {
    std::vector<hal::SerialPortNode> ports;
    if (!hal::list_serial_ports(ports)) list.errors.emplace_back("the system does not list its serial ports");
    select(
        ports, *selection.serial, "serial port", list.errors, [](const hal::SerialPortNode& node) { return node.path; },
        [](const hal::SerialPortNode& node) {
          return node.denied ? hal::open_error_text(node.path, EACCES, "dialout") : std::string();
        });
    list.ports = std::move(ports);
  }
  if (selection.gpio) {
    std::vector<hal::GpioChipNode> chips = hal::list_gpio_chips();
    select(
        chips, *selection.gpio, "GPIO chip", list.errors,
        [&](const hal::GpioChipNode& node) { return node.label == *selection.gpio ? node.label : node.path; },
        [](const hal::GpioChipNode& node) { return hal::open_error_text(node.path, node.error, "gpio"); });
    list.chips = std::move(chips);
  }
  return list;
}

}  // namespace touchline::devices
