#include "tools/programs/calibrate/imaging/channel_image.h"

#include <algorithm>
#include <cmath>

namespace touchline::calibrate {

Channels channels_of(const std::array<double, 3>& rgb, ColorSpace space) {
  std::array<float, 3> limited{};
  for (std::size_t c = 0; c < 3; ++c) limited[c] = static_cast<float>(std::clamp(rgb[c], 0.0, 255.0));
  const std::array<float, 3> value = from_rgb(limited, space);
  Channels out{};
  for (std::size_t c = 0; c < 3; ++c) out[c] = static_cast<std::uint8_t>(std::clamp(std::lround(value[c]), 0L, 255L));
  return out;
}

ChannelImage corrected_channels(const Frame& frame, const Shading& shading) {
  ChannelImage image{frame.width_px, frame.height_px, color_space(frame.format), {}};
  image.pixels.resize(static_cast<std::size_t>(image.width_px) * static_cast<std::size_t>(image.height_px));
  for (int v = 0; v < image.height_px; ++v) {
    for (int u = 0; u < image.width_px; ++u) {
      Channels value = pixel_at(frame, static_cast<std::size_t>(u), static_cast<std::size_t>(v));
      if (shading.active()) {
        const auto column = static_cast<std::uint16_t>(u / kTileWidth),
                   row = static_cast<std::uint16_t>(v / kTileHeight);
        for (std::size_t c = 0; c < 3; ++c) {
          value[c] = corrected(value[c], shading.level(c, column, row), black_value(image.space, c));
        }
      }
      image.pixels[image.index(u, v)] = value;
    }
  }
  return image;
}

double color_distance(const Channels& a, const Channels& b, ColorSpace space) {
  const std::array<double, 3> weight =
      is_yuv(space) ? std::array<double, 3>{0.25, 4.0, 4.0} : std::array<double, 3>{1.0, 1.0, 1.0};
  double sum = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    const double d = static_cast<double>(a[c]) - static_cast<double>(b[c]);
    sum += weight[c] * d * d;
  }
  return std::sqrt(sum);
}

std::vector<std::uint8_t> inside_mask(const Polygon& polygon, int width_px, int height_px) {
  const auto size = static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px);
  if (polygon.size() < 3) return std::vector<std::uint8_t>(size, 1);
  std::vector<std::uint8_t> mask(size, 0);
  for (int v = 0; v < height_px; ++v) {
    std::vector<float> crossings;
    const auto row = static_cast<float>(v);
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const PixelPoint a = polygon[i], b = polygon[(i + 1) % polygon.size()];
      if ((a.v_px <= row) != (b.v_px <= row)) {
        crossings.push_back(a.u_px + (row - a.v_px) / (b.v_px - a.v_px) * (b.u_px - a.u_px));
      }
    }
    std::sort(crossings.begin(), crossings.end());
    for (std::size_t i = 0; i + 1 < crossings.size(); i += 2) {
      for (int u = 0; u < width_px; ++u) {
        const auto x = static_cast<float>(u);
        if (x >= crossings[i] && x <= crossings[i + 1]) {
          mask[static_cast<std::size_t>(v) * static_cast<std::size_t>(width_px) + static_cast<std::size_t>(u)] = 1;
        }
      }
    }
  }
  return mask;
}

}  // namespace touchline::calibrate
