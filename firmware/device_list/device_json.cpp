#include <array>
#include <cerrno>
#include <nlohmann/json.hpp>

#include "firmware/device_list/device_list.h"
#include "hal/linux/system_error.h"

namespace touchline::devices {
namespace {

using Json = nlohmann::ordered_json;

Json json_of(const hal::V4l2FormatInfo& format) {
  Json sizes = Json::array();
  for (const hal::V4l2FrameSize& size : format.sizes) {
    Json entry{{"width_px", size.width_px}, {"height_px", size.height_px}};
    if (size.max_width_px != size.width_px || size.max_height_px != size.height_px) {
      entry["max_width_px"] = size.max_width_px;
      entry["max_height_px"] = size.max_height_px;
    }
    entry[size.rates_are_range ? "rate_range_hz" : "rates_hz"] = size.rates_hz;
    sizes.push_back(std::move(entry));
  }
  return {{"format", format.word}, {"fourcc", format.code}, {"description", format.description}, {"sizes", sizes}};
}

Json json_of(const hal::V4l2ControlState& control) {
  Json entry{{"id", control.id},
             {"name", control.name},
             {"key", control.key},
             {"low", control.low},
             {"high", control.high},
             {"step", control.step},
             {"default", control.default_value}};
  entry["value"] = control.readable ? Json(control.value) : Json();
  entry["read_only"] = control.read_only;
  entry["inactive"] = control.inactive;
  for (const auto& [value, name] : control.menu) entry["menu"][std::to_string(value)] = name;
  return entry;
}

Json json_of(const Camera& camera) {
  const hal::CameraNode& node = camera.node;
  Json entry{{"path", node.path}, {"by_path", node.by_path}, {"by_id", node.by_id}};
  if (node.error != 0) {
    entry["refused"] = hal::open_error_text(node.path, node.error, "video");
    return entry;
  }
  entry["card"] = node.identity.card;
  entry["driver"] = node.identity.driver;
  entry["bus"] = node.identity.bus;
  entry["multi_planar"] = node.identity.multi_planar;
  entry["formats"] = Json::array();
  for (const hal::V4l2FormatInfo& format : camera.formats) entry["formats"].push_back(json_of(format));
  entry["controls"] = Json::array();
  for (const hal::V4l2ControlState& control : camera.controls) entry["controls"].push_back(json_of(control));
  return entry;
}

Json json_of(const hal::SerialPortNode& port) {
  constexpr std::array<const char*, 3> kKinds{"native", "usb", "bluetooth"};
  Json entry{{"path", port.path},
             {"by_id", port.by_id},
             {"by_path", port.by_path},
             {"description", port.description},
             {"kind", kKinds[static_cast<std::size_t>(port.kind)]}};
  if (port.usb_vendor >= 0) {
    entry["usb_vendor"] = port.usb_vendor;
    entry["usb_product"] = port.usb_product;
  }
  if (port.denied) entry["refused"] = hal::open_error_text(port.path, EACCES, "dialout");
  return entry;
}

Json json_of(const hal::GpioChipNode& chip) {
  Json entry{{"path", chip.path}};
  if (chip.error != 0) {
    entry["refused"] = hal::open_error_text(chip.path, chip.error, "gpio");
    return entry;
  }
  entry["label"] = chip.label;
  entry["line_count"] = chip.line_count;
  entry["lines"] = Json::array();
  for (const hal::GpioLineNode& pin : chip.lines) {
    entry["lines"].push_back({{"line", pin.number},
                              {"name", pin.name},
                              {"direction", pin.output ? "output" : "input"},
                              {"used", pin.used},
                              {"consumer", pin.consumer},
                              {"active_low", pin.active_low},
                              {"bias", pin.bias}});
  }
  return entry;
}

Json json_of(const hal::LibcameraOffer& camera) {
  Json formats = Json::array();
  for (const hal::V4l2FormatInfo& format : camera.formats) formats.push_back(json_of(format));
  return {{"id", camera.name.id},
          {"model", camera.name.model},
          {"external", camera.name.external},
          {"formats", std::move(formats)}};
}

template <class Node>
void add(Json& document, const char* key, const std::optional<std::vector<Node>>& nodes) {
  if (!nodes) return;
  document[key] = Json::array();
  for (const Node& node : *nodes) document[key].push_back(json_of(node));
}

}  // namespace

std::string to_json(const DeviceList& list) {
  Json document = Json::object();
  add(document, "cameras", list.cameras);
  if (!list.libcamera.empty()) add(document, "libcamera", std::optional(list.libcamera));
  add(document, "serial_ports", list.ports);
  add(document, "gpio_chips", list.chips);
  // Names come from devices and may contain any bytes.
  return document.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace touchline::devices
