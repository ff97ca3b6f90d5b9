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

/// What is looked for: absent: this kind is not asked for; "": all of it; else one device, by its file or a link to it.
struct Selection {
  std::optional<std::string> camera, serial, gpio;
  bool libcamera = false;  // its cameras too; starts the library
};

struct DeviceList {
  std::optional<std::vector<Camera>> cameras;
  std::vector<hal::LibcameraName> libcamera;
  std::optional<std::vector<hal::SerialPortNode>> ports;
  std::optional<std::vector<hal::GpioChipNode>> chips;
  std::vector<std::string> troubles;  // a device that was asked for by name is not there, or cannot be asked
};

/// Asks the system. Opens cameras and GPIO chips, changes nothing.
DeviceList list_devices(const Selection& selection);

/// For a person: what there is, what of it goes into board.toml, and what to do where there is none.
std::string to_text(const DeviceList& list);
/// The same for programs, in one object; keys are those of the fields here, units in their names.
std::string to_json(const DeviceList& list);

}  // namespace touchline::devices
