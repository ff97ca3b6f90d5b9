#pragma once

#include <optional>
#include <string>
#include <vector>

#include "hal/linux/gpio/gpio_list.h"
#include "hal/linux/libcamera/libcamera_link.h"
#include "hal/linux/serial/serial_list.h"
#include "hal/linux/v4l2/camera_list.h"
#include "hal/linux/v4l2/v4l2_control_list.h"
#include "hal/linux/v4l2/v4l2_format_list.h"

namespace touchline::devices {

struct Camera {
  hal::CameraNode node;
  std::vector<hal::V4l2FormatInfo> formats;
  std::vector<hal::V4l2ControlState> controls;
};

/// Devices to list. No value: none of this kind; "": all; otherwise one device, by its file or a link to it.
struct Selection {
  std::optional<std::string> camera, serial, gpio;
  bool libcamera = false;  // also list the cameras of libcamera, which starts the library
};

struct DeviceList {
  std::optional<std::vector<Camera>> cameras;
  std::vector<hal::LibcameraName> libcamera;
  std::optional<std::vector<hal::SerialPortNode>> ports;
  std::optional<std::vector<hal::GpioChipNode>> chips;
  std::vector<std::string> errors;  // requested devices that are missing or cannot be opened
};

/// Lists the devices of the system. Opens cameras and GPIO chips, but changes nothing.
DeviceList list_devices(const Selection& selection);

/// Formats the list for a person: devices, their names for board.toml, and hints if there are none.
std::string to_text(const DeviceList& list);
/// Formats the list as one JSON object. Its keys are the names of the members, with units.
std::string to_json(const DeviceList& list);

}  // namespace touchline::devices
