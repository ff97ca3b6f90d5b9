#include "firmware/device_list/suggestion.h"

#include <algorithm>
#include <cstdlib>
#include <tuple>

namespace touchline::devices {
namespace {

constexpr long kWidth = 640, kHeight = 480;

std::optional<hal::CameraFormat> format_of(const std::string& word) {
  const auto* const found = std::find_if(hal::kCameraFormats.begin(), hal::kCameraFormats.end(),
                                         [&](const auto& choice) { return choice.word == word; });
  if (found == hal::kCameraFormats.end()) return std::nullopt;
  return found->value;
}

std::string first_of(std::initializer_list<std::string> names) {
  const auto* const named = std::find_if(names.begin(), names.end(), [](const std::string& n) { return !n.empty(); });
  return named == names.end() ? std::string() : *named;
}

}  // namespace

std::optional<hal::CameraSettings> suggested_settings(const Camera& camera) {
  std::optional<hal::CameraSettings> best;
  std::tuple<long, double, bool> rank_of_best;
  for (const hal::V4l2FormatInfo& offer : camera.formats) {
    const std::optional<hal::CameraFormat> format = format_of(offer.word);
    if (!format) continue;
    for (const hal::V4l2FrameSize& size : offer.sizes) {
      // The size of a range that is closest; drivers with ranges accept multiples of at least 2 pixels.
      const long width = std::clamp<long>(kWidth, size.width_px, size.max_width_px);
      const long height = std::clamp<long>(kHeight, size.height_px, size.max_height_px);
      if (width > static_cast<long>(kMaxFrameWidth) || height > static_cast<long>(kMaxFrameHeight)) continue;
      const double rate = size.rates_hz.empty() ? 0.0 : *std::max_element(size.rates_hz.begin(), size.rates_hz.end());
      const std::tuple rank{std::labs(width - kWidth) + std::labs(height - kHeight), -rate,
                            *format == hal::CameraFormat::kMjpg};
      if (best && rank >= rank_of_best) continue;
      rank_of_best = rank;
      best.emplace();
      best->backend = hal::CameraBackend::kV4l2;
      best->device = lasting_name(camera.node);
      best->format = *format;
      best->width_px = static_cast<std::uint16_t>(width);
      best->height_px = static_cast<std::uint16_t>(height);
      if (rate > 0.0) best->rate_hz = rate;
    }
  }
  return best;
}

std::string lasting_name(const hal::CameraNode& camera) {
  return first_of({camera.by_id, camera.by_path, camera.path});
}

std::string lasting_name(const hal::SerialPortNode& port) { return first_of({port.by_id, port.by_path, port.path}); }

}  // namespace touchline::devices
