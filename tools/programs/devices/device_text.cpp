#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdarg>
#include <cstdio>

#include "firmware/device_list/device_list.h"
#include "hal/linux/system_error.h"

namespace touchline::devices {
namespace {

/// Appends a line; the arguments are as for printf.
__attribute__((format(printf, 2, 3))) void line(std::string& text, const char* format, ...) {
  std::array<char, 1024> buffer{};
  std::va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(buffer.data(), buffer.size(), format, arguments);
  va_end(arguments);
  text.append(buffer.data()).append("\n");
}

std::string rates_text(const hal::V4l2FrameSize& size) {
  std::string text;
  for (const double rate_hz : size.rates_hz) {
    std::array<char, 32> number{};
    std::snprintf(number.data(), number.size(), "%.4g", rate_hz);
    text += (text.empty() ? " at " : size.rates_are_range ? " to " : ", ") + std::string(number.data());
  }
  return text.empty() ? text : text + " Hz";
}

void add_formats(std::string& text, const std::vector<hal::V4l2FormatInfo>& formats) {
  if (formats.empty()) line(text, "    no formats");
  for (const hal::V4l2FormatInfo& format : formats) {
    line(text, "    %-5s  %s%s", (format.word.empty() ? format.code : format.word).c_str(), format.description.c_str(),
         format.word.empty() ? " (Touchline does not read it)" : "");
    for (const hal::V4l2FrameSize& size : format.sizes) {
      std::string words = hal::size_text(size.width_px, size.height_px);
      if (size.max_width_px != size.width_px || size.max_height_px != size.height_px) {
        words += " to " + hal::size_text(size.max_width_px, size.max_height_px);
      }
      line(text, "           %s%s", words.c_str(), rates_text(size).c_str());
    }
  }
}

std::string value_text(const hal::V4l2ControlState& control, std::int64_t value) {
  for (const auto& [item, name] : control.menu) {
    if (item == value) return std::to_string(value) + " (" + name + ")";
  }
  return std::to_string(value);
}

/// Returns the values that a control can have. Menus of USB cameras have gaps; then only the existing values are
/// listed.
std::string range_text(const hal::V4l2ControlState& control) {
  const auto numbers = static_cast<std::size_t>(control.high - control.low) + 1;
  if (control.menu.empty() || control.menu.size() == numbers) {
    return std::to_string(control.low) + " to " + std::to_string(control.high);
  }
  std::string text;
  for (const auto& [item, name] : control.menu) text += (text.empty() ? "" : ", ") + std::to_string(item);
  return text;
}

void add_controls(std::string& text, const std::vector<hal::V4l2ControlState>& controls) {
  if (controls.empty()) {
    line(text, "    no controls");
    return;
  }
  line(text, "    %-32s %-26s %-18s %6s  %-26s %s", "control", "now", "range", "step", "default", "board.toml");
  for (const hal::V4l2ControlState& control : controls) {
    const std::string now = control.readable ? value_text(control, control.value) : "?";
    const std::string range = range_text(control);
    line(text, "    %-32s %-26s %-18s %6lld  %-26s %s%s%s", control.name.c_str(), now.c_str(), range.c_str(),
         static_cast<long long>(control.step), value_text(control, control.default_value).c_str(), control.key.c_str(),
         control.inactive ? " (without effect now)" : "", control.read_only ? " (read only)" : "");
  }
}

void add_cameras(std::string& text, const std::vector<Camera>& cameras) {
  line(text, "cameras");
  if (cameras.empty()) {
    line(text, "  none found by Video4Linux. Is the camera plugged in (`lsusb`), and its driver loaded (`dmesg`)?");
  }
  for (const Camera& camera : cameras) {
    const hal::CameraNode& node = camera.node;
    if (node.error != 0) {
      line(text, "  %s", hal::open_error_text(node.path, node.error, "video").c_str());
      continue;
    }
    line(text, "  %s  %s (driver %s, %s%s)", node.path.c_str(), node.identity.card.c_str(),
         node.identity.driver.c_str(), node.identity.bus.c_str(), node.identity.multi_planar ? ", multi-planar" : "");
    if (!node.by_path.empty()) line(text, "    device = \"%s\"", node.by_path.c_str());
    if (!node.by_id.empty()) line(text, "    by id: %s", node.by_id.c_str());
    add_formats(text, camera.formats);
    add_controls(text, camera.controls);
  }
}

void add_libcamera(std::string& text, const std::vector<hal::LibcameraName>& cameras) {
  if (!cameras.empty()) line(text, "cameras of libcamera (backend = \"libcamera\")");
  for (const hal::LibcameraName& camera : cameras) {
    line(text, "  %s%s", camera.model.c_str(), camera.external ? " (USB camera: prefer backend v4l2)" : "");
    line(text, "    device = \"%s\"", camera.id.c_str());
  }
}

void add_ports(std::string& text, const std::vector<hal::SerialPortNode>& ports) {
  line(text, "serial ports");
  if (ports.empty()) line(text, "  none. Is the adapter plugged in (`lsusb`), or the UART enabled?");
  for (const hal::SerialPortNode& port : ports) {
    std::array<char, 32> usb{};
    if (port.usb_vendor >= 0) {
      std::snprintf(usb.data(), usb.size(), " (USB %04x:%04x)", static_cast<unsigned>(port.usb_vendor),
                    static_cast<unsigned>(port.usb_product));
    }
    line(text, "  %s  %s%s", port.path.c_str(), port.description.c_str(), usb.data());
    if (port.denied) line(text, "    %s", hal::open_error_text(port.path, EACCES, "dialout").c_str());
    if (!port.by_id.empty()) line(text, "    device = \"%s\"", port.by_id.c_str());
    if (!port.by_path.empty()) line(text, "    by USB port: %s", port.by_path.c_str());
  }
}

void add_chips(std::string& text, const std::vector<hal::GpioChipNode>& chips) {
  line(text, "GPIO chips");
  if (chips.empty()) line(text, "  none; a PC has no GPIO lines");
  for (const hal::GpioChipNode& chip : chips) {
    if (chip.error != 0) {
      line(text, "  %s", hal::open_error_text(chip.path, chip.error, "gpio").c_str());
      continue;
    }
    line(text, "  %s  %s, %u lines", chip.path.c_str(), chip.label.c_str(), chip.line_count);
    const bool is_sole = std::count_if(chips.begin(), chips.end(),
                                       [&](const hal::GpioChipNode& other) { return other.label == chip.label; }) == 1;
    line(text, "    chip = \"%s\"", is_sole && !chip.label.empty() ? chip.label.c_str() : chip.path.c_str());
    if (chip.lines.size() < chip.line_count) line(text, "    Linux 5.10 and later also report which lines are free");
    for (const hal::GpioLineNode& pin : chip.lines) {
      const std::string holder = !pin.used ? "free" : "held by " + (pin.consumer.empty() ? "the kernel" : pin.consumer);
      line(text, "    %4u  %-20s %-6s %s%s%s%s", pin.number, pin.name.empty() ? "-" : pin.name.c_str(),
           pin.output ? "output" : "input", holder.c_str(), pin.active_low ? ", active low" : "",
           *pin.bias != '\0' ? ", bias " : "", pin.bias);
    }
  }
}

}  // namespace

std::string to_text(const DeviceList& list) {
  std::string text;
  if (list.cameras) add_cameras(text, *list.cameras);
  add_libcamera(text, list.libcamera);
  if (list.ports) add_ports(text, *list.ports);
  if (list.chips) add_chips(text, *list.chips);
  return text;
}

}  // namespace touchline::devices
