#include "tools/programs/calibrate/field/border_outline.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace touchline::calibrate {
namespace {

constexpr double kMinEnclosed = 0.1;
// Least area of the border's bounding box, as a share of the picture. Regions between the lines of the field are
// larger; specks and letters are smaller.
constexpr double kMinArea = 0.001;

std::vector<std::uint8_t> brightness(const hal::Picture& picture) {
  std::vector<std::uint8_t> luma(std::size_t{picture.width_px} * picture.height_px);
  for (std::size_t i = 0; i < luma.size(); ++i) {
    const std::uint8_t* rgb = &picture.rgb8[3 * i];
    // White is bright in all channels, colored objects are not.
    luma[i] = std::min({rgb[0], rgb[1], rgb[2]});
  }
  return luma;
}

int otsu(const std::vector<std::uint8_t>& values) {
  std::array<double, 256> histogram{};
  for (const std::uint8_t value : values) ++histogram[value];
  double total = 0, sum = 0;
  for (std::size_t i = 0; i < histogram.size(); ++i) {
    total += histogram[i];
    sum += static_cast<double>(i) * histogram[i];
  }
  double below = 0, sum_below = 0, best = -1;
  int threshold = 128;
  for (std::size_t i = 0; i + 1 < histogram.size(); ++i) {
    below += histogram[i];
    sum_below += static_cast<double>(i) * histogram[i];
    if (below <= 0 || below >= total) continue;
    const double apart = sum_below / below - (sum - sum_below) / (total - below);
    const double between = below * (total - below) * apart * apart;
    if (between > best) {
      best = between;
      threshold = static_cast<int>(i) + 1;
    }
  }
  return threshold;
}

// Pixel indices of a picture of given size and their neighbors.
class Grid {
 public:
  Grid(int width, int height) : width_(width), height_(height) {}
  [[nodiscard]] std::size_t size() const {
    return static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
  }
  [[nodiscard]] int u(std::size_t i) const { return static_cast<int>(i % static_cast<std::size_t>(width_)); }
  [[nodiscard]] int v(std::size_t i) const { return static_cast<int>(i / static_cast<std::size_t>(width_)); }
  [[nodiscard]] bool at_edge(std::size_t i) const {
    return u(i) == 0 || v(i) == 0 || u(i) == width_ - 1 || v(i) == height_ - 1;
  }
  template <class Visit>
  void neighbors(std::size_t i, bool diagonal, Visit visit) const {
    for (int dv = -1; dv <= 1; ++dv) {
      for (int du = -1; du <= 1; ++du) {
        const int nu = u(i) + du, nv = v(i) + dv;
        if ((du == 0 && dv == 0) || (!diagonal && du != 0 && dv != 0)) continue;
        if (nu < 0 || nv < 0 || nu >= width_ || nv >= height_) continue;
        visit(static_cast<std::size_t>(nv) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(nu));
      }
    }
  }

 private:
  int width_, height_;
};

// Flood fill: marks `seeds` and all pixels connected to them for which `may` holds in `reached`. Pixels that are
// already marked are not entered.
template <class May>
std::vector<std::size_t> flood(const Grid& grid, std::vector<std::size_t> seeds, bool diagonal, May may,
                               std::vector<std::uint8_t>& reached) {
  for (const std::size_t seed : seeds) reached[seed] = 1;
  for (std::size_t next = 0; next < seeds.size(); ++next) {
    grid.neighbors(seeds[next], diagonal, [&](std::size_t n) {
      if (reached[n] != 0 || !may(n)) return;
      reached[n] = 1;
      seeds.push_back(n);
    });
  }
  return seeds;
}

// Size of the bounding box of the pixels.
std::size_t box_area(const Grid& grid, const std::vector<std::size_t>& pixels) {
  int left = grid.u(pixels[0]), right = left, top = grid.v(pixels[0]), bottom = top;
  for (const std::size_t i : pixels) {
    left = std::min(left, grid.u(i));
    right = std::max(right, grid.u(i));
    top = std::min(top, grid.v(i));
    bottom = std::max(bottom, grid.v(i));
  }
  return static_cast<std::size_t>(right - left + 1) * static_cast<std::size_t>(bottom - top + 1);
}

// Returns the pixels inside that touch the region, without specks, because a noisy floor as bright as the border is
// full of specks.
std::vector<OutlinePixel> outline_of(const Grid& grid, const std::vector<std::uint8_t>& in_piece,
                                     const std::vector<std::uint8_t>& outside) {
  const auto inside = [&](std::size_t k) { return in_piece[k] == 0 && outside[k] == 0; };
  std::vector<std::uint8_t> visited(grid.size());
  std::vector<OutlinePixel> outline;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (visited[i] != 0 || !inside(i)) continue;
    const std::vector<std::size_t> area = flood(grid, {i}, false, inside, visited);
    if (static_cast<double>(area.size()) < kMinArea * static_cast<double>(grid.size())) continue;
    for (const std::size_t k : area) {
      bool at_border = false;
      grid.neighbors(k, false, [&](std::size_t n) { at_border = at_border || in_piece[n] != 0; });
      if (at_border) outline.push_back({static_cast<double>(grid.u(k)), static_cast<double>(grid.v(k))});
    }
  }
  return outline;
}

}  // namespace

int brightness_threshold(const hal::Picture& picture) { return otsu(brightness(picture)); }

std::vector<OutlinePixel> border_outline(const hal::Picture& picture, int threshold) {
  const Grid grid(static_cast<int>(picture.width_px), static_cast<int>(picture.height_px));
  const std::vector<std::uint8_t> luma = brightness(picture);
  const auto bright = [&](std::size_t i) { return luma[i] >= threshold; };
  std::vector<std::size_t> rim;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (grid.at_edge(i)) rim.push_back(i);
  }
  std::vector<std::uint8_t> seen(grid.size());
  std::vector<OutlinePixel> best;
  std::size_t most = static_cast<std::size_t>(kMinEnclosed * static_cast<double>(grid.size()));
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (seen[i] != 0 || !bright(i)) continue;
    const std::vector<std::size_t> piece = flood(grid, {i}, true, bright, seen);
    // Skips specks: a region with a smaller bounding box cannot be the border.
    if (box_area(grid, piece) <= most) continue;
    std::vector<std::uint8_t> in_piece(grid.size()), outside(grid.size());
    for (const std::size_t k : piece) in_piece[k] = 1;
    const auto is_free = [&](std::size_t k) { return in_piece[k] == 0; };
    std::vector<std::size_t> seeds;
    std::copy_if(rim.begin(), rim.end(), std::back_inserter(seeds), is_free);
    const std::size_t enclosed = grid.size() - piece.size() - flood(grid, seeds, false, is_free, outside).size();
    if (enclosed <= most) continue;
    most = enclosed;
    best = outline_of(grid, in_piece, outside);
  }
  return best;
}

}  // namespace touchline::calibrate
