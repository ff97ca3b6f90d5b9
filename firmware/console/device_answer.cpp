#include "firmware/console/device_answer.h"

#include <libwebsockets.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "firmware/console/device_queries.h"
#include "firmware/console/jpeg_encoder.h"
#include "firmware/device_list/device_list.h"
#include "firmware/device_list/suggestion.h"
#include "hal/linux/libcamera/libcamera_camera.h"
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
// Longest waits for the driver of one device, which has kPatience for its picture and opens and closes the camera, and
// for all devices.
constexpr Duration kPatienceEach = 5s, kPatienceAll = 20s;

using Json = nlohmann::json;
using Outcome = DeviceQueries::Outcome;

std::string resolved(const std::string& device) {
  const std::unique_ptr<char, decltype(&std::free)> path(::realpath(device.c_str(), nullptr), &std::free);
  return path != nullptr ? path.get() : device;
}

Json json_of(const hal::CameraSettings& settings) {
  return {{"backend", std::string(hal::kCameraBackends[static_cast<std::size_t>(settings.backend)].word)},
          {"device", settings.device},
          {"format", std::string(hal::kCameraFormats[static_cast<std::size_t>(settings.format)].word)},
          {"width_px", settings.width_px},
          {"height_px", settings.height_px},
          {"rate_hz", settings.rate_hz}};
}

/// Takes a picture. `camera` is closed.
Result<std::vector<std::byte>> thumbnail(hal::Camera& camera, const std::string& device) {
  TOUCHLINE_TRY(camera.open());
  TOUCHLINE_TRY(camera.start());
  const Instant end = hal::MonotonicClock::read() + kPatience;
  std::vector<std::byte> jpeg;
  for (int frame = 0; frame <= kThumbnailFrame;) {
    const Result<hal::FrameLease> lease = camera.wait(end);
    if (hal::MonotonicClock::read() >= end)
      return failure(ErrorCode::kTimeout, "%s: the camera delivered no picture in time; check its cable and format",
                     device.c_str());
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

/// Makes the list of one request.
class DeviceAnswer {
 public:
  void add_cameras(const hal::CameraSettings& used, int priority, const MakeLibcameraLink& make_link);
  void add_ports();
  std::string text() const { return answer_.dump(-1, ' ', false, Json::error_handler_t::replace); }

 private:
  /// Asks for a result that a thread which is abandoned may still write to. Nothing: the reason is in `why`.
  template <class Value>
  std::optional<Value> ask(const std::string& name, std::function<Value()> query, std::string& why,
                           bool lowers_priority = true) {
    const auto result = std::make_shared<std::optional<Value>>();
    const Outcome outcome = queries_.ask(
        name, [result, query = std::move(query)] { *result = query(); }, lowers_priority);
    if (outcome == Outcome::kAnswered && *result) return std::move(**result);
    why = outcome == Outcome::kNotAsked ? name + ": was not asked, because other devices took too long"
          : outcome == Outcome::kSilent ? name + ": its driver does not answer; unplug the device, or restart the board"
                                        : name + ": its driver failed, or memory is short";
    return std::nullopt;
  }
  void add_libcamera(const hal::CameraSettings& used, int priority, const MakeLibcameraLink& make_link);
  void add_v4l2(const std::string& path, const hal::CameraSettings& used);
  /// Adds what can be tried to an entry, and a small picture unless the loop has the camera.
  void add_suggestion(Json& entry, const std::optional<hal::CameraSettings>& settings,
                      const std::function<std::unique_ptr<hal::Camera>(const hal::CameraSettings&)>& make);
  void add_problem(const std::string& text) { answer_["problems"].push_back(text); }

  DeviceQueries queries_{kPatienceEach, kPatienceAll};
  Json answer_{{"problems", Json::array()}};
  bool has_ribbon_ = false;  // a camera of libcamera that is no USB camera
};

void DeviceAnswer::add_suggestion(Json& entry, const std::optional<hal::CameraSettings>& settings,
                                  const std::function<std::unique_ptr<hal::Camera>(const hal::CameraSettings&)>& make) {
  const std::string path = entry["path"];
  if (!settings) {
    entry["refused"] = path + ": offers no format that Touchline reads";
    return;
  }
  entry["suggested"] = json_of(*settings);
  if (entry["used"]) return;
  std::string why;
  const auto jpeg = ask<Result<std::vector<std::byte>>>(
      path, [make, settings = *settings] { return thumbnail(*make(settings), settings.device); }, why);
  if (jpeg && jpeg->ok()) {
    entry["thumbnail"] = "data:image/jpeg;base64," + base64(jpeg->value());
  } else {
    entry["refused"] = jpeg ? jpeg->text() : why;
  }
}

void DeviceAnswer::add_libcamera(const hal::CameraSettings& used, int priority, const MakeLibcameraLink& make_link) {
  std::string why;
  const auto offers = ask<std::vector<hal::LibcameraOffer>>(
      "libcamera", [priority, make_link] { return hal::libcamera_offers(make_link().get(), priority); }, why, false);
  if (!offers) return add_problem(why);
  std::vector<hal::LibcameraName> names;
  for (const hal::LibcameraOffer& offer : *offers) names.push_back(offer.name);
  const hal::LibcameraName* const chosen =
      used.backend == hal::CameraBackend::kLibcamera ? hal::choose(names, used.device) : nullptr;
  for (const hal::LibcameraOffer& offer : *offers) {
    const bool is_used = chosen != nullptr && chosen->id == offer.name.id;
    has_ribbon_ = has_ribbon_ || !offer.name.external;
    if (offer.name.external && !is_used) continue;
    devices::DeviceList list;
    list.libcamera = {offer};
    Json entry = Json::parse(devices::to_json(list))["libcamera"][0];
    entry.update({{"backend", "libcamera"}, {"path", offer.name.id}, {"name", offer.name.id}, {"used", is_used}});
    entry["card"] = offer.name.model;
    add_suggestion(entry, devices::suggested_settings(offer), [priority, make_link](const hal::CameraSettings& mode) {
      return std::make_unique<hal::LibcameraCamera>(mode, priority, make_link());
    });
    answer_["cameras"].push_back(std::move(entry));
  }
}

void DeviceAnswer::add_v4l2(const std::string& path, const hal::CameraSettings& used) {
  const bool is_used = used.backend == hal::CameraBackend::kV4l2 && resolved(path) == resolved(used.device);
  std::string why;
  auto found = ask<std::optional<devices::Camera>>(
      path, [path] { return devices::query_camera(path); }, why);
  if (found && !*found) return;  // it captures nothing
  devices::Camera camera = found ? std::move(**found) : devices::Camera{hal::unopened_camera(path), {}, {}};
  devices::DeviceList list;
  list.cameras = {camera};
  Json entry = Json::parse(devices::to_json(list))["cameras"][0];
  entry.erase("controls");
  entry.update({{"backend", "v4l2"}, {"name", devices::lasting_name(camera.node)}, {"used", is_used}});
  if (!found) {
    entry["refused"] = why;
  } else if (has_ribbon_ && !is_used && camera.node.identity.bus.starts_with("platform:")) {
    entry["refused"] = path + ": belongs to a camera on a ribbon cable, which libcamera reads";
  } else if (!entry.contains("refused")) {
    add_suggestion(entry, devices::suggested_settings(camera),
                   [](const hal::CameraSettings& mode) { return std::make_unique<hal::V4l2Camera>(mode); });
  }
  answer_["cameras"].push_back(std::move(entry));
}

void DeviceAnswer::add_cameras(const hal::CameraSettings& used, int priority, const MakeLibcameraLink& make_link) {
  answer_["cameras"] = Json::array();
  add_libcamera(used, priority, make_link);
  for (const std::string& path : hal::camera_files()) add_v4l2(path, used);
}

void DeviceAnswer::add_ports() {
  const auto add = [this](const char* name, const char* key, const devices::Selection& selection) {
    std::string why;
    const auto list = ask<devices::DeviceList>(
        name, [selection] { return devices::list_devices(selection); }, why);
    answer_[key] = Json::array();
    if (!list) return add_problem(why);
    answer_.update(Json::parse(devices::to_json(*list)));
    for (std::size_t i = 0; list->ports && i < list->ports->size(); ++i) {
      answer_[key][i]["name"] = devices::lasting_name((*list->ports)[i]);
    }
  };
  add("serial ports", "serial_ports", {.camera = std::nullopt, .serial = "", .gpio = std::nullopt});
  add("GPIO chips", "gpio_chips", {.camera = std::nullopt, .serial = std::nullopt, .gpio = ""});
}

}  // namespace

std::string device_answer(const hal::CameraSettings& used, int priority, const MakeLibcameraLink& make_link) {
  DeviceAnswer answer;
  answer.add_ports();  // first: a camera that hangs may take the time of all
  answer.add_cameras(used, priority, make_link);
  return answer.text();
}

std::string port_answer() {
  DeviceAnswer answer;
  answer.add_ports();
  return answer.text();
}

}  // namespace touchline::console
