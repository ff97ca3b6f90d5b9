#include "core/marker/clipping_level.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "core/marker/surface_color.h"

namespace touchline {
namespace {

constexpr std::size_t kRowStep = 8, kColumnStep = 2;
// White, which is the brightest surface of most pictures, has nearly equal channels.
constexpr int kColored_levels = 10;
// Sampled pixels at the highest value: those of one patch are more.
constexpr int kLeastClipped = 8;
// Without clipping, values become rarer towards the highest one. Clipping collects all that would lie above it: more
// than this many levels below it have together.
constexpr int kLevelsBelow = 3;

}  // namespace

int saturated_from(const Frame& frame) {
  if (color_space(frame.format) != ColorSpace::kRgb) return kSaturatedValue;
  const PixelFormatInfo& info = info_of(frame.format);
  std::array<int, 256> colored{};  // pixels by their highest channel
  int highest = 0;
  for (std::size_t v = 0; v < frame.height_px; v += kRowStep) {
    std::array<const std::uint8_t*, 3> line{};
    for (std::size_t c = 0; c < 3; ++c) {
      const ChannelLayout& channel = info.channel[c];
      line[c] = frame.plane[channel.plane] + (v >> channel.shift_v) * frame.stride_bytes[channel.plane];
    }
    for (std::size_t u = 0; u < frame.width_px; u += kColumnStep) {
      const int red = line[0][info.channel[0].byte(u)], green = line[1][info.channel[1].byte(u)],
                blue = line[2][info.channel[2].byte(u)];
      const int most = std::max({red, green, blue}), least = std::min({red, green, blue});
      if (most >= kSaturatedValue) return kSaturatedValue;
      highest = std::max(highest, most);
      if (most - least >= kColored_levels) ++colored[static_cast<std::size_t>(most)];
    }
  }
  int below = 0;
  for (int level = std::max(0, highest - kLevelsBelow); level < highest; ++level) {
    below += colored[static_cast<std::size_t>(level)];
  }
  const int clipped = colored[static_cast<std::size_t>(highest)];
  if (clipped < kLeastClipped || clipped <= below) return kSaturatedValue;
  // As far below the highest value as usual.
  return highest * kSaturatedValue / 255;
}

}  // namespace touchline
