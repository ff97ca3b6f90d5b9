#include "tools/programs/devices/judge/camera_choice.h"

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <optional>

#include "firmware/device_list/suggestion.h"
#include "hal/linux/system_error.h"

namespace touchline::devices {
namespace {

constexpr double kGameRate_hz = 60.0;
// The Raspberry Pi's modules with global shutter deliver this size at 60 Hz, and its ISP scales the pictures of every
// sensor to it.
constexpr std::uint16_t kLibcameraWidth_px = 1280, kLibcameraHeight_px = 960;

std::string real_path(const std::string& path) {
  const std::unique_ptr<char, decltype(&std::free)> real(::realpath(path.c_str(), nullptr), &std::free);
  return real != nullptr ? real.get() : path;
}

hal::CameraSettings with_v4l2(const std::string& device) {
  hal::CameraSettings settings;
  settings.backend = hal::CameraBackend::kV4l2;
  settings.device = device;
  return settings;
}

Result<hal::CameraSettings> choose_v4l2(const std::string& device, const std::string& mode,
                                        const std::vector<hal::CameraNode>& nodes) {
  const std::string path = real_path(device);
  const auto node =
      std::find_if(nodes.begin(), nodes.end(), [&](const hal::CameraNode& here) { return here.path == path; });
  if (node == nodes.end()) {
    return failure(ErrorCode::kNotFound, "%s: no such camera; here: %s", device.c_str(),
                   hal::available_cameras().c_str());
  }
  if (node->error != 0) {
    return failure(ErrorCode::kIo, "%s", hal::open_error_text(node->path, node->error, "video").c_str());
  }
  hal::CameraSettings settings = with_v4l2(device);
  if (!mode.empty()) {
    TOUCHLINE_TRY(parse_mode(mode, settings));
    return settings;
  }
  hal::V4l2Device opened;
  if (const int error = opened.open(node->path); error != 0) {
    return failure(ErrorCode::kIo, "%s", hal::open_error_text(node->path, error, "video").c_str());
  }
  const std::vector<hal::V4l2FormatInfo> formats = hal::list_formats(opened, node->identity.multi_planar, true);
  if (!choose_mode(formats, settings)) {
    return failure(ErrorCode::kUnsupported,
                   "%s: %s. A sensor on a ribbon cable is read with libcamera: "
                   "touchline-devices --judge auto",
                   device.c_str(), hal::formats_text(formats).c_str());
  }
  return settings;
}

Result<hal::CameraSettings> choose_libcamera(const std::string& device, const std::string& mode) {
  const std::vector<hal::LibcameraName> cameras = hal::libcamera_cameras();
  if (hal::choose(cameras, device) == nullptr) {
    return failure(ErrorCode::kNotFound,
                   "%s: no such camera, or several; libcamera has: %s. A camera of the kernel is named by its file, "
                   "such as /dev/video0",
                   device.c_str(), hal::list_of(cameras).c_str());
  }
  hal::CameraSettings settings;
  settings.backend = hal::CameraBackend::kLibcamera;
  settings.device = device;
  settings.format = hal::CameraFormat::kNv12;
  settings.width_px = kLibcameraWidth_px;
  settings.height_px = kLibcameraHeight_px;
  settings.rate_hz = kGameRate_hz;
  if (!mode.empty()) TOUCHLINE_TRY(parse_mode(mode, settings));
  return settings;
}

}  // namespace

Result<void> parse_mode(const std::string& text, hal::CameraSettings& settings) {
  const std::size_t comma = text.find(',');
  const std::optional<hal::CameraFormat> format = format_of(text.substr(0, comma));
  unsigned width = 0, height = 0;
  double rate_hz = 0.0;
  int used = 0;
  const std::string rest = comma == std::string::npos ? "" : text.substr(comma + 1);
  const int numbers = std::sscanf(rest.c_str(), "%5ux%5u,%lf%n", &width, &height, &rate_hz, &used);
  if (!format || numbers != 3 || static_cast<std::size_t>(used) != rest.size() || width < 16 ||
      width > kMaxFrameWidth || height < 16 || height > kMaxFrameHeight || !(rate_hz > 0.0 && rate_hz <= 1000.0)) {
    return failure(ErrorCode::kInconsistent,
                   "\"%s\" is not FORMAT,WIDTHxHEIGHT,RATE, as in mjpg,1280x720,60; touchline-devices --camera lists "
                   "what a camera offers",
                   text.c_str());
  }
  settings.format = *format;
  settings.width_px = static_cast<std::uint16_t>(width);
  settings.height_px = static_cast<std::uint16_t>(height);
  settings.rate_hz = rate_hz;
  return {};
}

Result<hal::CameraSettings> choose_camera(const std::string& device, const std::string& mode) {
  if (!device.empty() && device[0] != '/') return choose_libcamera(device, mode);
  const std::vector<hal::CameraNode> nodes = hal::list_cameras();
  if (!device.empty()) return choose_v4l2(device, mode, nodes);
  // If a sensor is on a ribbon cable, some of the kernel's devices belong to its ISP and deliver nothing on their own,
  // so libcamera is preferred.
  const std::vector<hal::LibcameraName> cameras = hal::libcamera_cameras();
  const bool has_ribbon = std::any_of(cameras.begin(), cameras.end(), [](const auto& here) { return !here.external; });
  if (has_ribbon) return choose_libcamera("auto", mode);
  std::string refusals;
  for (const hal::CameraNode& node : nodes) {
    Result<hal::CameraSettings> chosen = choose_v4l2(node.by_path.empty() ? node.path : node.by_path, mode, nodes);
    if (chosen.ok()) return chosen;
    refusals += "\n  " + chosen.text();
  }
  if (!cameras.empty()) return choose_libcamera("auto", mode);
  return failure(ErrorCode::kNotFound,
                 "no camera delivers pictures. Is it plugged in (`lsusb`), and its driver loaded (`dmesg`)? "
                 "`touchline-devices --judge --board boards/mock/board.toml` shows the measurement in a simulation.%s",
                 refusals.c_str());
}

}  // namespace touchline::devices
