#include "tools/programs/calibrate/colors/region_growing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "tools/programs/statistics/statistics.h"

namespace touchline::calibrate {
namespace {

constexpr int kMaxDistance = 255;
constexpr int kOutside = kMaxDistance + 1;

// The seed color is the median of the pixels around the click, so that one noisy pixel has no influence.
Channels seed_color(const ChannelImage& image, int u, int v) {
  Channels seed{};
  for (std::size_t c = 0; c < 3; ++c) {
    std::vector<std::uint8_t> values;
    for (int dv = -1; dv <= 1; ++dv) {
      for (int du = -1; du <= 1; ++du) {
        if (image.contains(u + du, v + dv)) values.push_back(image.at(u + du, v + dv)[c]);
      }
    }
    seed[c] = statistics::median(values);
  }
  return seed;
}

// Computes for each pixel of a window the smallest tolerance at which growth from the center reaches it.
class Window {
 public:
  Window(const ChannelImage& image, const std::vector<std::uint8_t>& inside, int u, int v, int radius)
      : left_(u - radius), top_(v - radius), side_(2 * radius + 1) {
    const Channels seed = seed_color(image, u, v);
    const auto cells = static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_);
    // Distances are computed on demand, because growth does not reach most of the window.
    const auto distance = [&](int x, int y) {
      if (!image.contains(left_ + x, top_ + y) || inside[image.index(left_ + x, top_ + y)] == 0) return kOutside;
      return std::min(kMaxDistance, static_cast<int>(color_distance(image.at(left_ + x, top_ + y), seed, image.space)));
    };
    reached_at_.assign(cells, kOutside);
    // One queue per tolerance. The tolerance of a pixel is the largest distance along its best path (minimax path).
    std::vector<std::vector<std::size_t>> queue(kMaxDistance + 1);
    const std::size_t start = cell(radius, radius);
    const int at_start = distance(radius, radius);
    if (at_start == kOutside) return;
    reached_at_[start] = at_start;
    queue[static_cast<std::size_t>(at_start)].push_back(start);
    // Regions that reach the window's edge are too large for patches.
    for (int t = 0; t <= std::min(kMaxDistance, border_at_); ++t) {
      auto& ready = queue[static_cast<std::size_t>(t)];
      for (std::size_t i = 0; i < ready.size(); ++i) {  // `ready` grows in this loop
        const int x = static_cast<int>(ready[i]) % side_, y = static_cast<int>(ready[i]) / side_;
        constexpr std::array<std::array<int, 2>, 4> kSteps = {{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};
        for (const auto& step : kSteps) {
          const int nx = x + step[0], ny = y + step[1];
          if (nx < 0 || ny < 0 || nx >= side_ || ny >= side_) continue;
          const std::size_t next = cell(nx, ny);
          if (reached_at_[next] != kOutside) continue;
          const int there = distance(nx, ny);
          if (there == kOutside) continue;
          reached_at_[next] = std::max(t, there);
          if (nx == 0 || ny == 0 || nx == side_ - 1 || ny == side_ - 1) {
            border_at_ = std::min(border_at_, reached_at_[next]);
          }
          queue[static_cast<std::size_t>(reached_at_[next])].push_back(next);
        }
      }
    }
  }

  // Returns the tolerance at which growth reaches the edge of the window.
  [[nodiscard]] int border_at() const { return border_at_; }

  // Writes the number of pixels reached at each tolerance, up to the edge of the window.
  void areas(std::array<double, kMaxDistance + 1>& area) const {
    area.fill(0);
    for (int y = 0; y < side_; ++y) {
      for (int x = 0; x < side_; ++x) {
        const int t = reached_at_[cell(x, y)];
        if (t == kOutside) continue;
        area[static_cast<std::size_t>(t)] += 1;
      }
    }
    for (std::size_t t = 1; t < area.size(); ++t) area[t] += area[t - 1];
  }

  void pixels(const ChannelImage& image, int tolerance, std::vector<std::size_t>& out) const {
    for (int y = 0; y < side_; ++y) {
      for (int x = 0; x < side_; ++x) {
        if (reached_at_[cell(x, y)] <= tolerance) out.push_back(image.index(left_ + x, top_ + y));
      }
    }
  }

 private:
  [[nodiscard]] std::size_t cell(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(side_) + static_cast<std::size_t>(x);
  }
  int left_, top_, side_;
  int border_at_ = kOutside;
  std::vector<int> reached_at_;
};

}  // namespace

Result<GrownPatch> grow_region(const ChannelImage& image, const std::vector<std::uint8_t>& inside, double u_px,
                               double v_px, const GrowthLimits& limits) {
  const int u = static_cast<int>(std::lround(u_px)), v = static_cast<int>(std::lround(v_px));
  if (!image.contains(u, v)) {
    return failure(ErrorCode::kNotFound, "outside the picture (%d x %d)", image.width_px, image.height_px);
  }
  if (inside[image.index(u, v)] == 0) {
    return Error{ErrorCode::kNotFound, "outside the region of interest"};
  }
  const Window window(image, inside, u, v, limits.radius_px);
  std::array<double, kMaxDistance + 1> area{};
  window.areas(area);
  const int border_at = window.border_at();

  // Minimizes the relative growth of the area around a tolerance. Two levels to either side cover pixel noise. Of two
  // equal plateaus the one with the lower tolerance wins, because the other may include a neighboring patch.
  constexpr int kStep = 4;
  constexpr double kPriceOfTolerance = 0.004;
  constexpr double kUnstable = 0.8;
  double best_score = std::numeric_limits<double>::infinity();
  int best = -1;
  for (int t = kStep; t + kStep <= kMaxDistance && t + kStep < border_at; ++t) {
    const auto level = static_cast<std::size_t>(t);
    const double here = area[level];
    if (here < static_cast<double>(limits.min_area_px)) continue;
    const double growth = (area[level + kStep] - area[level - kStep]) / here;
    const double score = growth + kPriceOfTolerance * t;
    if (growth < kUnstable && score < best_score) {
      best_score = score;
      best = t;
    }
  }
  if (best < 0) {
    if (border_at <= 2 * kStep) {
      return failure(ErrorCode::kNotFound, "the surface clicked on is larger than a patch (%d px around the click)",
                     limits.radius_px);
    }
    if (area[static_cast<std::size_t>(std::min(border_at, kMaxDistance))] < static_cast<double>(limits.min_area_px)) {
      return failure(ErrorCode::kNotFound, "fewer than %zu pixels of one color (an edge or noise)", limits.min_area_px);
    }
    return failure(ErrorCode::kNotFound, "no edge around it: the color merges into its surroundings");
  }
  GrownPatch patch;
  patch.tolerance = best;
  patch.instability = best_score;
  window.pixels(image, best, patch.pixels);
  return patch;
}

}  // namespace touchline::calibrate
