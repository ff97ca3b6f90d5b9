#include "tests/region/patterns.h"

#include <algorithm>
#include <cstdlib>

#include "tests/region/tile_recipe.h"

namespace touchline::testing {
namespace {

constexpr char kSlowestFound[] =
    "20x5 scale 8x4 shift 10 noise 114 runs 2 seed 1889376308 cells "
    "0101011000000051100000111111111111111111111111111111111111111111111111111111111111111111111111111111";

ColorId any_color(std::mt19937& random) { return static_cast<ColorId>(pick(random, 1, kPaletteColors)); }

void draw_spiral(ColorGrid& grid, ColorId color) {
  // Walks inwards, always one pixel away from the pixels that are already drawn.
  int left = 0, top = 0, right = grid.width - 1, bottom = grid.height - 1;
  int u = 0, v = 0;
  const auto go = [&](int to_u, int to_v) {
    while (true) {
      grid.at(u, v) = color;
      if (u == to_u && v == to_v) break;
      u += (to_u > u) - (to_u < u);
      v += (to_v > v) - (to_v < v);
    }
  };
  while (left <= right && top <= bottom) {
    go(right, v);
    go(u, bottom);
    if (bottom - top < 2) break;
    go(left, v);
    top += 2;
    if (top > bottom) break;
    go(u, top);
    left += 2, right -= 2, bottom -= 2;
    if (right <= u || bottom < top) break;
  }
}

void draw_blobs(ColorGrid& grid, std::mt19937& random) {
  const int disks = 2 + grid.width * grid.height / 2000;
  for (int i = 0; i < disks; ++i) {
    const int u0 = pick(random, 0, grid.width - 1), v0 = pick(random, 0, grid.height - 1);
    const int radius = pick(random, 1, 9);
    const ColorId color = any_color(random);
    for (int v = std::max(0, v0 - radius); v <= std::min(grid.height - 1, v0 + radius); ++v) {
      for (int u = std::max(0, u0 - radius); u <= std::min(grid.width - 1, u0 + radius); ++u) {
        if ((u - u0) * (u - u0) + (v - v0) * (v - v0) <= radius * radius) grid.at(u, v) = color;
      }
    }
  }
  for (int i = 0; i < disks * 2; ++i) {
    grid.at(pick(random, 0, grid.width - 1), pick(random, 0, grid.height - 1)) = any_color(random);
  }
}

// The patterns in which the color of a pixel depends only on its position.
ColorId color_at(Pattern pattern, const ColorGrid& grid, int u, int v, ColorId color) {
  const auto painted = [color](bool is) { return is ? color : kBackground; };
  const auto numbered = [](int number) { return static_cast<ColorId>(1 + number % kPaletteColors); };
  switch (pattern) {
    case Pattern::kFull:
      return color;
    case Pattern::kCheckerboard:
      return painted((u + v) % 2 == 0);
    case Pattern::kWideCheckerboard:
      return numbered(u / 2 + v / 2 * 2);
    case Pattern::kVerticalStripes:
      return numbered(u);
    case Pattern::kHorizontalStripes:
      return painted(v % 2 == 0);
    case Pattern::kCombUp:
      return painted(u % 2 == 0 || v == grid.height - 1);
    case Pattern::kCombDown:
      return painted(u % 2 == 0 || v == 0);
    case Pattern::kNestedArches:
      return painted(std::min({u, grid.width - 1 - u, v}) % 2 == 0);
    case Pattern::kStairs:
      return painted((u + v) % 3 != 0);
    default:
      return kBackground;
  }
}

bool inside(const Polygon& polygon, int u, int v) {
  // Exact, in half pixels: a ray to the left crosses an odd number of edges, including those through the point.
  bool odd = false;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const PixelPoint& a = polygon[i];
    const PixelPoint& b = polygon[(i + 1) % polygon.size()];
    const auto half = [](float x) { return static_cast<long>(x * 2.0f); };
    long u0 = half(a.u_px), v0 = half(a.v_px), u1 = half(b.u_px), v1 = half(b.v_px);
    if (v0 > v1) std::swap(u0, u1), std::swap(v0, v1);
    if (!(v0 <= 2 * v && 2 * v < v1)) continue;
    // True if the edge is at the pixel's center or left of it.
    if ((2 * u - u0) * (v1 - v0) >= (2 * v - v0) * (u1 - u0)) odd = !odd;
  }
  return odd;
}

}  // namespace

const char* name_of(Pattern pattern) {
  constexpr std::array names = {"empty",
                                "full",
                                "salt",
                                "percolation",
                                "two colors",
                                "checkerboard",
                                "wide checkerboard",
                                "vertical stripes",
                                "horizontal stripes",
                                "comb up",
                                "comb down",
                                "nested arches",
                                "spiral",
                                "stairs",
                                "blobs",
                                "slowest picture found by a search"};
  return names[static_cast<std::size_t>(pattern)];
}

ColorBoxes palette() {
  ColorBoxes boxes;
  for (int color = 1; color <= kPaletteColors; ++color) {
    ColorBox box;
    box.color = static_cast<ColorId>(color);
    box.low = {static_cast<std::uint8_t>(40 * color), 0, 16};
    box.high = {static_cast<std::uint8_t>(40 * color + 29), 255, 240};
    boxes.push_back(box);
  }
  return boxes;
}

ColorGrid make_pattern(Pattern pattern, int width, int height, std::mt19937& random) {
  if (pattern == Pattern::kFound) return make_tiles(recipe_of(kSlowestFound).value(), width, height);
  ColorGrid grid = make_grid(width, height);
  const ColorId color = any_color(random);
  if (pattern == Pattern::kSpiral) draw_spiral(grid, color);
  if (pattern == Pattern::kBlobs) draw_blobs(grid, random);
  if (pattern == Pattern::kSpiral || pattern == Pattern::kBlobs) return grid;
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      ColorId& pixel = grid.at(u, v);
      if (pattern == Pattern::kSalt) {
        pixel = static_cast<ColorId>(pick(random, 0, kPaletteColors));
      } else if (pattern == Pattern::kPercolation) {
        pixel = pick(random, 0, 999) < 593 ? color : kBackground;
      } else if (pattern == Pattern::kTwoColors) {
        pixel = static_cast<ColorId>(pick(random, 1, 2));
      } else {
        pixel = color_at(pattern, grid, u, v, color);
      }
    }
  }
  return grid;
}

OwnedPicture paint(const ColorGrid& grid, PixelFormat format, int padding, std::mt19937& random) {
  OwnedPicture picture(format, grid.width, grid.height, padding);
  picture.fill([&] { return static_cast<std::uint8_t>(random()); });
  for (int v = 0; v < grid.height; ++v) {
    for (int u = 0; u < grid.width; ++u) {
      const int color = grid.at(u, v);
      const int value = color == kBackground ? pick(random, 0, 39) : 40 * color + pick(random, 0, 29);
      picture.set(u, v,
                  {static_cast<std::uint8_t>(value), static_cast<std::uint8_t>(random()),
                   static_cast<std::uint8_t>(pick(random, 16, 240))});
    }
  }
  return picture;
}

ScanParameters parameters_for(const Frame& frame) {
  ScanParameters parameters;
  parameters.format = frame.format;
  parameters.width_px = frame.width_px;
  parameters.height_px = frame.height_px;
  parameters.boxes = palette();
  return parameters;
}

ColorGrid defined_colors(const Frame& frame, const ScanParameters& parameters) {
  static Shading shading;
  if (!shading.build(parameters.light, frame.width_px, frame.height_px, color_space(frame.format)).ok()) std::abort();
  ColorGrid grid = make_grid(frame.width_px, frame.height_px);
  for (int v = 0; v < grid.height; ++v) {
    for (int u = 0; u < grid.width; ++u) {
      if (parameters.region_of_interest.size() >= 3 && !inside(parameters.region_of_interest, u, v)) continue;
      Channels level = {kNeutralLevel, kNeutralLevel, kNeutralLevel};
      for (std::size_t c = 0; c < 3 && shading.active(); ++c) {
        level[c] =
            shading.level(c, static_cast<std::uint16_t>(u / kTileWidth), static_cast<std::uint16_t>(v / kTileHeight));
      }
      grid.at(u, v) = color_by_boxes(parameters.boxes, color_space(frame.format), channels_at(frame, u, v), level);
    }
  }
  return grid;
}

}  // namespace touchline::testing
