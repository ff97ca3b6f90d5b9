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

/// What the classifier sees of a picture: a value a pixel, in raster order.
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

/// Reads the frame as the classifier does: shared chroma, then the tile's gain (eq. 17).
ChannelImage corrected_channels(const Frame& frame, const Shading& shading);

/// Distance of two colors in levels of the camera's space; in YUV luma counts half and chroma twice: chroma spans half
/// of what luma does and carries what makes a patch differ from its neighbor.
double color_distance(const Channels& a, const Channels& b, ColorSpace space);

/// A color of the camera's space for showing to a person (YUV: ITU-R BT.601, limited range).
Channels shown_rgb(const Channels& value, ColorSpace space);

/// Pixels whose center lies in the polygon, one byte a pixel; all of them when it has fewer than three corners.
std::vector<std::uint8_t> inside_mask(const Polygon& polygon, int width_px, int height_px);

}  // namespace touchline::calibrate
