#pragma once

#include <vector>

#include "core/types.h"

namespace touchline::testing {

struct Pixel {
  int u = 0, v = 0;
  friend bool operator==(const Pixel&, const Pixel&) = default;
};

/// A picture of colors.
struct ColorGrid {
  int width = 0, height = 0;
  std::vector<ColorId> color;  // row by row
  [[nodiscard]] ColorId at(int u, int v) const { return color[index(u, v)]; }
  ColorId& at(int u, int v) { return color[index(u, v)]; }
  [[nodiscard]] std::size_t index(int u, int v) const {
    return static_cast<std::size_t>(v) * static_cast<std::size_t>(width) + static_cast<std::size_t>(u);
  }
};
ColorGrid make_grid(int width, int height);

struct PixelList {
  ColorId color = kBackground;
  std::vector<Pixel> pixels;  // pixels in the order in which they were added
};

/// A literal implementation of the algorithm of the paper's section 4.1, in one pass: a pixel opens a new region or
/// joins the region of its upper or left neighbor. If both neighbors have its color but belong to different regions,
/// the pixels of the smaller region are copied to the larger one and the smaller one is deleted. Regions are in no
/// particular order. Memory is reused from picture to picture, for benchmarks.
class LiteralLabeling {
 public:
  const std::vector<PixelList>& label(const ColorGrid& grid);

 private:
  std::size_t new_region(ColorId color);
  std::size_t merge(std::size_t a, std::size_t b, const ColorGrid& grid);

  std::vector<std::size_t> region_of_;  // region of each pixel
  std::vector<PixelList> regions_;
  std::vector<std::size_t> deleted_;  // empty lists that can be reused
};

}  // namespace touchline::testing
