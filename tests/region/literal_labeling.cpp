#include "tests/region/literal_labeling.h"

#include <utility>

namespace touchline::testing {

ColorGrid make_grid(int width, int height) {
  ColorGrid grid;
  grid.width = width;
  grid.height = height;
  grid.color.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  return grid;
}

const std::vector<PixelList>& LiteralLabeling::label(const ColorGrid& grid) {
  for (std::size_t i = 0; i < regions_.size(); ++i) {
    if (regions_[i].pixels.empty()) continue;
    regions_[i].pixels.clear();
    deleted_.push_back(i);
  }
  region_of_.resize(grid.color.size());
  for (int v = 0; v < grid.height; ++v) {
    for (int u = 0; u < grid.width; ++u) {
      const ColorId color = grid.at(u, v);
      if (color == kBackground) continue;
      const bool joins_left = u > 0 && grid.at(u - 1, v) == color;
      const bool joins_upper = v > 0 && grid.at(u, v - 1) == color;
      std::size_t region = 0;
      if (joins_left && joins_upper) {
        region = merge(region_of_[grid.index(u - 1, v)], region_of_[grid.index(u, v - 1)], grid);
      } else if (joins_left) {
        region = region_of_[grid.index(u - 1, v)];
      } else if (joins_upper) {
        region = region_of_[grid.index(u, v - 1)];
      } else {
        region = new_region(color);
      }
      regions_[region].pixels.push_back({u, v});
      region_of_[grid.index(u, v)] = region;
    }
  }
  return regions_;
}

std::size_t LiteralLabeling::new_region(ColorId color) {
  if (deleted_.empty()) {
    regions_.emplace_back();
    deleted_.push_back(regions_.size() - 1);
  }
  const std::size_t region = deleted_.back();
  deleted_.pop_back();
  regions_[region].color = color;
  return region;
}

std::size_t LiteralLabeling::merge(std::size_t a, std::size_t b, const ColorGrid& grid) {
  if (a == b) return a;
  if (regions_[a].pixels.size() < regions_[b].pixels.size()) std::swap(a, b);
  for (const Pixel& pixel : regions_[b].pixels) {
    regions_[a].pixels.push_back(pixel);
    region_of_[grid.index(pixel.u, pixel.v)] = a;
  }
  regions_[b].pixels.clear();
  deleted_.push_back(b);
  return a;
}

}  // namespace touchline::testing
