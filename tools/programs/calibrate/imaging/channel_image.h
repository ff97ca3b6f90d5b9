#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/light/shading.h"
#include "core/region/region_scanner.h"
#include "core/types.h"

namespace touchline::calibrate {

/// Three channel values in the camera's color space, after the light correction.
using Channels = std::array<std::uint8_t, 3>;

/// A picture as the color classifier gets it: one value per pixel in raster order.
struct ChannelImage {
  int width_px = 0, height_px = 0;
  ColorSpace space = ColorSpace::kRgb;
  std::vector<Channels> pixels;

  [[nodiscard]] bool contains(int u, int v) const { return u >= 0 && v >= 0 && u < width_px && v < height_px; }
  [[nodiscard]] std::size_t index(int u, int v) const {
    return static_cast<std::size_t>(v) * static_cast<std::size_t>(width_px) + static_cast<std::size_t>(u);
  }
  [[nodiscard]] const Channels& at(int u, int v) const { return pixels[index(u, v)]; }
};

/// Reads the frame as the classifier does: chroma is shared between neighbors, then each value is multiplied by the
/// gain of its tile (Klancar eq. 17).
ChannelImage corrected_channels(const Frame& frame, const Shading& shading);

/// Converts R, G, B from 0 to 255 to channels, rounded and limited.
Channels channels_of(const std::array<double, 3>& rgb, ColorSpace space);

/// Distance of two colors in levels of the camera's color space. In YUV, luma has half the weight and chroma twice,
/// because chroma spans half the range of luma and carries most of the difference between a patch and its surroundings.
double color_distance(const Channels& a, const Channels& b, ColorSpace space);

/// Marks the pixels whose center lies in the polygon: one byte per pixel, 1 inside. With fewer than three corners, all
/// pixels are inside.
std::vector<std::uint8_t> inside_mask(const Polygon& polygon, int width_px, int height_px);

}  // namespace touchline::calibrate
