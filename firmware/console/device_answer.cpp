#include "firmware/console/device_answer.h"

#include <libwebsockets.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "firmware/console/jpeg_encoder.h"
#include "firmware/device_list/device_list.h"
#include "firmware/device_list/suggestion.h"
#include "hal/linux/monotonic_clock.h"
#include "hal/linux/v4l2/v4l2_camera.h"

namespace touchline::console {
namespace {

using namespace std::chrono_literals;

constexpr int kThumbnailWidth = 320, kQuality = 70;
// Number of the frame that is used for the small picture. The automatic exposure of a newly opened camera settles
// within a few frames.
constexpr int kThumbnailFrame = 4;
constexpr Duration kPatience = 2s;

std::string resolved(const std::string& device) {
  const std::unique_ptr<char, decltype(&std::free)> path(::realpath(device.c_str(), nullptr), &std::free);
  return path != nullptr ? path.get() : device;
}

nlohmann::json json_of(const hal::CameraSettings& settings) {
  return {{"device", settings.device},
          {"format", std::string(hal::kCameraFormats[static_cast<std::size_t>(settings.format)].word)},
          {"width_px", settings.width_px},
          {"height_px", settings.height_px},
          {"rate_hz", settings.rate_hz}};
}

Result<std::vector<std::byte>> thumbnail(const hal::CameraSettings& settings) {
  hal::V4l2Camera camera(settings);
  TOUCHLINE_TRY(camera.open());
  TOUCHLINE_TRY(camera.start());
  const Instant end = hal::MonotonicClock::read() + kPatience;
  std::vector<std::byte> jpeg;
  for (int frame = 0; frame <= kThumbnailFrame;) {
    const Result<hal::FrameLease> lease = camera.wait(end);
    if (hal::MonotonicClock::read() >= end)
      return failure(ErrorCode::kTimeout, "%s: the camera delivered no picture in time; check its cable and format",
                     settings.device.c_str());
    const bool is_skipped = lease.code() == ErrorCode::kTimeout || lease.code() == ErrorCode::kShortFrame ||
                            lease.code() == ErrorCode::kCorruptFrame;
    if (!lease.ok() && !is_skipped) return lease.error();
    if (!lease.ok() || ++frame <= kThumbnailFrame) continue;
    const Frame& picture = lease.value().frame();
    const int divisor = std::clamp((picture.width_px + kThumbnailWidth - 1) / kThumbnailWidth, 1, 8);
    jpeg.resize(std::size_t{picture.width_px} * picture.height_px * 3 + 4096);
    const Result<std::size_t> size = JpegEncoder().encode(picture, divisor, kQuality, jpeg);
    if (!size.ok()) return size.error();
    jpeg.resize(size.value());
  }
  camera.stop();
  return jpeg;
}

std::string base64(const std::vector<std::byte>& bytes) {
  std::string text(bytes.size() / 3 * 4 + 8, '\0');
  const int size = lws_b64_encode_string(reinterpret_cast<const char*>(bytes.data()), static_cast<int>(bytes.size()),
                                         text.data(), static_cast<int>(text.size()));
  text.resize(size > 0 ? static_cast<std::size_t>(size) : 0);
  return text;
}

}  // namespace

std::string device_answer(const std::string& used_camera) {
  const devices::DeviceList list = devices::list_devices({.camera = "", .serial = std::nullopt, .gpio = std::nullopt});
  nlohmann::json answer = nlohmann::json::parse(devices::to_json(list));
  for (std::size_t i = 0; i < list.cameras->size(); ++i) {
    const devices::Camera& camera = (*list.cameras)[i];
    nlohmann::json& entry = answer["cameras"][i];
    entry.erase("controls");
    entry["name"] = devices::lasting_name(camera.node);
    entry["used"] = resolved(camera.node.path) == resolved(used_camera);
    if (entry.contains("refused")) continue;
    const std::optional<hal::CameraSettings> settings = devices::suggested_settings(camera);
    if (!settings) {
      entry["refused"] = camera.node.path + ": offers no format that Touchline reads";
      continue;
    }
    entry["suggested"] = json_of(*settings);
    if (entry["used"]) continue;
    const Result<std::vector<std::byte>> jpeg = thumbnail(*settings);
    if (jpeg.ok()) {
      entry["thumbnail"] = "data:image/jpeg;base64," + base64(jpeg.value());
    } else {
      entry["refused"] = jpeg.text();
    }
  }
  answer.update(nlohmann::json::parse(port_answer()));
  return answer.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string port_answer() {
  const devices::DeviceList list = devices::list_devices({.camera = std::nullopt, .serial = "", .gpio = ""});
  nlohmann::json answer = nlohmann::json::parse(devices::to_json(list));
  for (std::size_t i = 0; i < list.ports->size(); ++i) {
    answer["serial_ports"][i]["name"] = devices::lasting_name((*list.ports)[i]);
  }
  return answer.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace touchline::console
