#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace touchline {

/// The three channels of a pixel. Color boxes are in the color space of the pixels.
enum class ColorSpace : std::uint8_t {
  kRgb,
  kYuv,  // limited range: luma from 16 to 235 and chroma from 16 to 240 (ITU-R BT.601), as most cameras deliver
  kYuvFullRange,  // all channels from 0 to 255, as in JPEG (JFIF 1.02)
};
inline constexpr std::array kColorSpaces{ColorSpace::kRgb, ColorSpace::kYuv, ColorSpace::kYuvFullRange};

constexpr bool is_yuv(ColorSpace space) { return space != ColorSpace::kRgb; }

/// Returns the value of black in a channel; light scales the distance of values from it: 0 for R, G and B, 16 (limited
/// range) or 0 for luma, 128 for chroma.
constexpr std::uint8_t black_value(ColorSpace space, std::size_t channel) {
  if (space == ColorSpace::kRgb) return 0;
  if (channel > 0) return 128;
  return space == ColorSpace::kYuv ? 16 : 0;
}

/// Conversion from YUV to RGB by ITU-R BT.601. The factors are in 1 / kOne.
struct YuvToRgb {
  static constexpr int kOne = 1024;
  int luma, red_v, green_u, green_v, blue_u;

  /// Returns R, G, B in the unit 1 / kOne, not limited to 0..255. `y`, `u`, `v`: differences from black. T: int or
  /// float.
  template <class T>
  [[nodiscard]] constexpr std::array<T, 3> of(T y, T u, T v) const {
    const T bright = static_cast<T>(luma) * y;
    return {bright + static_cast<T>(red_v) * v, bright - static_cast<T>(green_u) * u - static_cast<T>(green_v) * v,
            bright + static_cast<T>(blue_u) * u};
  }
};
/// Returns the conversion; `space` must be YUV.
constexpr YuvToRgb yuv_to_rgb(ColorSpace space) {
  return space == ColorSpace::kYuv ? YuvToRgb{1192, 1634, 401, 832, 2066} : YuvToRgb{1024, 1436, 352, 731, 1815};
}

/// Returns Y, U, V as differences from black, for R, G, B from 0 to 255 (ITU-R BT.601). `space` must be YUV.
constexpr std::array<float, 3> rgb_to_yuv(const std::array<float, 3>& rgb, ColorSpace space) {
  const bool is_limited = space == ColorSpace::kYuv;
  const float of_luma = is_limited ? 219.0f / 255.0f : 1.0f, of_chroma = is_limited ? 224.0f / 255.0f : 1.0f;
  const float luma = 0.299f * rgb[0] + 0.587f * rgb[1] + 0.114f * rgb[2];
  return {of_luma * luma, of_chroma * (rgb[2] - luma) / 1.772f, of_chroma * (rgb[0] - luma) / 1.402f};
}

/// Returns the channels for R, G, B from 0 to 255, not rounded and not limited.
constexpr std::array<float, 3> from_rgb(const std::array<float, 3>& rgb, ColorSpace space) {
  if (space == ColorSpace::kRgb) return rgb;
  std::array<float, 3> value = rgb_to_yuv(rgb, space);
  for (std::size_t c = 0; c < 3; ++c) value[c] += static_cast<float>(black_value(space, c));
  return value;
}

/// Converts a pixel to R, G, B, rounded and limited to 0..255.
constexpr std::array<std::uint8_t, 3> to_rgb8(const std::array<std::uint8_t, 3>& value, ColorSpace space) {
  if (space == ColorSpace::kRgb) return value;
  const auto above_black = [&](std::size_t c) { return int{value[c]} - black_value(space, c); };
  const std::array<int, 3> rgb = yuv_to_rgb(space).of(above_black(0), above_black(1), above_black(2));
  std::array<std::uint8_t, 3> bytes{};
  for (std::size_t c = 0; c < 3; ++c) {
    bytes[c] = static_cast<std::uint8_t>(std::clamp((rgb[c] + YuvToRgb::kOne / 2) >> 10, 0, 255));
  }
  return bytes;
}

}  // namespace touchline
