#include "tools/programs/calibrate/light/floor_light.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tools/programs/calibrate/imaging/local_background.h"
#include "tools/programs/statistics/statistics.h"

namespace touchline::calibrate {
namespace {

constexpr int kRim_px = 2;
// Largest change of the light over 40 pixels, half the window of LocalBackground. A steeper change is the reflection of
// a lamp.
constexpr double kSteepestLight = 0.15;
// Median absolute deviation of a normal distribution, as a fraction of sigma.
constexpr double kMadOfSigma = 0.6745;

}  // namespace

std::vector<std::uint8_t> plain_floor(const std::array<Plane, 3>& background, const std::vector<std::uint8_t>& inside,
                                      std::size_t width_px, std::size_t height_px) {
  ChannelImage image{static_cast<int>(width_px), static_cast<int>(height_px), ColorSpace::kRgb, {}};
  image.pixels.resize(width_px * height_px);
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      image.pixels[i][c] = static_cast<std::uint8_t>(std::lround(std::clamp(background[c][i], 0.0, 255.0)));
    }
  }
  const LocalBackground floor(image, inside);
  std::array<double, 3> noise{};
  for (std::size_t c = 0; c < 3; ++c) {
    std::vector<double> deviations;
    for (int v = 0; v < image.height_px; ++v) {
      for (int u = 0; u < image.width_px; ++u) {
        if (inside[image.index(u, v)] != 0) deviations.push_back(std::abs(image.at(u, v)[c] - floor.at(u, v)[c]));
      }
    }
    if (!deviations.empty()) noise[c] = std::max(1.0, statistics::median(deviations) / kMadOfSigma);
  }
  std::vector<std::uint8_t> plain = inside;
  for (int v = 0; v < image.height_px; ++v) {
    for (int u = 0; u < image.width_px; ++u) {
      if (inside[image.index(u, v)] == 0) continue;
      bool other = false;
      for (std::size_t c = 0; c < 3; ++c) {
        const double usual = floor.at(u, v)[c];
        other |= std::abs(image.at(u, v)[c] - usual) > 4 * noise[c] + kSteepestLight * usual;
      }
      if (!other) continue;
      for (int dv = -kRim_px; dv <= kRim_px; ++dv) {
        for (int du = -kRim_px; du <= kRim_px; ++du) {
          if (image.contains(u + du, v + dv)) plain[image.index(u + du, v + dv)] = 0;
        }
      }
    }
  }
  return plain;
}

void mend_floor(const LightGrid& grid, std::array<Plane, 3>& cells) {
  constexpr double kUnlike = 0.05;  // relative to the value; the noise of a cell's median is smaller
  constexpr double kNeighborhood = 2.5;
  constexpr int kMendingRounds = 4;
  for (int round = 0; round < kMendingRounds; ++round) {
    std::vector<bool> wrong(grid.cells(), false);
    for (const Plane& plane : cells) {
      const Plane expected = grid.around(plane, kNeighborhood);
      std::vector<double> deviations, sorted;
      for (std::size_t i = 0; i < grid.cells(); ++i) {
        const bool known = !std::isnan(plane[i]) && !std::isnan(expected[i]) && expected[i] > 0;
        deviations.push_back(known ? std::abs(plane[i] / expected[i] - 1.0) : 0.0);
        if (known) sorted.push_back(deviations.back());
      }
      if (sorted.empty()) continue;
      const double limit = std::max(kUnlike, 5 * statistics::median(sorted) / kMadOfSigma);
      for (std::size_t i = 0; i < grid.cells(); ++i) wrong[i] = wrong[i] || deviations[i] > limit;
    }
    for (Plane& plane : cells) {
      for (std::size_t i = 0; i < grid.cells(); ++i) {
        if (wrong[i]) plane[i] = std::numeric_limits<double>::quiet_NaN();
      }
    }
    if (std::find(wrong.begin(), wrong.end(), true) == wrong.end()) break;
  }
  for (Plane& plane : cells) {
    for (const double sigma : {1.5, 3.0, 6.0}) {
      const Plane expected = grid.around(plane, sigma);
      for (std::size_t i = 0; i < grid.cells(); ++i) {
        if (std::isnan(plane[i])) plane[i] = expected[i];
      }
    }
  }
}

}  // namespace touchline::calibrate
