#include "firmware/device_list/suggestion.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <tuple>

namespace touchline::devices {
namespace {

constexpr double kGameRate_hz = 60.0;
constexpr std::uint32_t kGameWidth_px = 1280, kGameHeight_px = 1024;

struct Mode {
  hal::CameraFormat format;
  std::uint32_t width_px, height_px;
  double rate_hz;

  [[nodiscard]] auto rank() const {
    return std::tuple(std::min(std::round(rate_hz), kGameRate_hz), width_px * height_px,
                      format != hal::CameraFormat::kMjpg);
  }
};

std::string first_of(std::initializer_list<std::string> names) {
  const auto* const named = std::find_if(names.begin(), names.end(), [](const std::string& n) { return !n.empty(); });
  return named == names.end() ? std::string() : *named;
}

}  // namespace

std::optional<hal::CameraFormat> format_of(const std::string& word) {
  for (const Choice<hal::CameraFormat>& choice : hal::kCameraFormats) {
    if (choice.word == word) return choice.value;
  }
  return std::nullopt;
}

bool choose_mode(const std::vector<hal::V4l2FormatInfo>& formats, hal::CameraSettings& settings) {
  std::optional<Mode> best;
  const auto consider = [&](hal::CameraFormat format, std::uint32_t width, std::uint32_t height, double rate_hz) {
    const Mode mode{format, width, height, rate_hz};
    if (!best || mode.rank() > best->rank()) best = mode;
  };
  for (const hal::V4l2FormatInfo& format : formats) {
    const std::optional<hal::CameraFormat> word = format_of(format.word);
    if (!word) continue;
    for (const hal::V4l2FrameSize& size : format.sizes) {
      // From a range of sizes, the game's size is taken if it is inside the range.
      const std::uint32_t width = std::clamp(kGameWidth_px, size.width_px, size.max_width_px);
      const std::uint32_t height = std::clamp(kGameHeight_px, size.height_px, size.max_height_px);
      if (width > kGameWidth_px || height > kGameHeight_px) continue;
      if (size.rates_hz.empty()) consider(*word, width, height, kGameRate_hz);
      for (const double rate_hz : size.rates_hz) consider(*word, width, height, rate_hz);
    }
  }
  if (!best) {
    // If all sizes are above the game's, the smallest one is taken.
    for (const hal::V4l2FormatInfo& format : formats) {
      const std::optional<hal::CameraFormat> word = format_of(format.word);
      if (!word) continue;
      for (const hal::V4l2FrameSize& size : format.sizes) {
        const Mode mode{*word, size.width_px, size.height_px, size.rates_hz.empty() ? kGameRate_hz : size.rates_hz[0]};
        if (!best || mode.width_px * mode.height_px < best->width_px * best->height_px) best = mode;
      }
    }
  }
  if (!best) return false;
  settings.format = best->format;
  settings.width_px = static_cast<std::uint16_t>(best->width_px);
  settings.height_px = static_cast<std::uint16_t>(best->height_px);
  settings.rate_hz = best->rate_hz;
  return true;
}

std::optional<hal::CameraSettings> suggested_settings(const Camera& camera) {
  hal::CameraSettings settings;
  settings.backend = hal::CameraBackend::kV4l2;
  settings.device = lasting_name(camera.node);
  if (!choose_mode(camera.formats, settings)) return std::nullopt;
  return settings;
}

std::optional<hal::CameraSettings> suggested_settings(const hal::LibcameraOffer& camera) {
  hal::CameraSettings settings;
  settings.backend = hal::CameraBackend::kLibcamera;
  settings.device = camera.name.id;
  std::vector<hal::V4l2FormatInfo> formats = camera.formats;
  std::stable_partition(formats.begin(), formats.end(), [](const auto& format) { return format.word == "nv12"; });
  if (!choose_mode(formats, settings)) return std::nullopt;
  return settings;
}

std::string lasting_name(const hal::CameraNode& camera) {
  return first_of({camera.by_id, camera.by_path, camera.path});
}

std::string lasting_name(const hal::SerialPortNode& port) { return first_of({port.by_id, port.by_path, port.path}); }

}  // namespace touchline::devices
