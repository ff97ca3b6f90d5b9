#include "tools/programs/calibrate/colors/initial_boxes.h"

#include <algorithm>
#include <array>
#include <optional>

namespace touchline::calibrate {
namespace {

// Pixels of a color that get one box.
struct Cluster {
  std::size_t color = 0;
  std::vector<ColorCount> pixels;
  ColorBox core;
  double conflict = 0;
};

// Returns the cost of a box: the shares of the other colors that it contains, and the share of the background relative
// to the allowed one.
double conflict_of(const LearningInput& input, const LearningRules& rules, const ColorBox& box, double background) {
  double sum = 0;
  for (std::size_t c = 0; c < input.colors.size(); ++c) {
    if (c + 1 == box.color) continue;
    sum += count_in(input.colors[c].pixels, box) / total(input.colors[c].pixels);
  }
  if (background > 0) {
    // Ten times the allowed share of background costs as much as a hundredth of another color.
    sum += 0.01 * count_in(input.background, box) / (10.0 * rules.background_share * background);
  }
  return sum;
}

struct Halves {
  Cluster low, high;
  double conflict = 0;
};

// Finds the cut with the least conflict among a few positions in each channel.
std::optional<Halves> best_split(const LearningInput& input, const LearningRules& rules, const Cluster& cluster,
                                 double background) {
  constexpr std::array<double, 5> kPlaces = {0.2, 0.35, 0.5, 0.65, 0.8};
  std::optional<Halves> best;
  for (std::size_t channel = 0; channel < 3; ++channel) {
    for (const double place : kPlaces) {
      const std::uint8_t cut = quantile(cluster.pixels, channel, place);
      Halves halves;
      halves.low.color = halves.high.color = cluster.color;
      for (const ColorCount& p : cluster.pixels) {
        (p.value[channel] <= cut ? halves.low : halves.high).pixels.push_back(p);
      }
      if (halves.low.pixels.empty() || halves.high.pixels.empty()) continue;
      for (Cluster* half : {&halves.low, &halves.high}) {
        half->core = core_of(half->pixels, static_cast<ColorId>(half->color + 1), rules.core_tail);
        half->conflict = conflict_of(input, rules, half->core, background);
      }
      // Both halves contain the cut, so they touch.
      halves.low.core.high[channel] = cut;
      halves.high.core.low[channel] = static_cast<std::uint8_t>(std::min(255, cut + 1));
      halves.high.core.high[channel] = std::max(halves.high.core.high[channel], halves.high.core.low[channel]);
      halves.conflict = halves.low.conflict + halves.high.conflict;
      if (!best || halves.conflict < best->conflict) best = std::move(halves);
    }
  }
  return best;
}

}  // namespace

double total(const std::vector<ColorCount>& pixels) {
  double sum = 0;
  for (const ColorCount& p : pixels) sum += p.count;
  return sum;
}

bool contains(const ColorBox& box, const Channels& value) {
  for (std::size_t c = 0; c < 3; ++c) {
    if (value[c] < box.low[c] || value[c] > box.high[c]) return false;
  }
  return true;
}

std::uint8_t quantile(const std::vector<ColorCount>& pixels, std::size_t channel, double share) {
  std::array<double, 256> histogram{};
  double all = 0;
  for (const ColorCount& p : pixels) {
    histogram[p.value[channel]] += p.count;
    all += p.count;
  }
  double sum = 0;
  for (std::size_t v = 0; v < 256; ++v) {
    sum += histogram[v];
    if (sum > share * all) return static_cast<std::uint8_t>(v);
  }
  return 255;
}

double count_in(const std::vector<ColorCount>& pixels, const ColorBox& box) {
  double sum = 0;
  for (const ColorCount& p : pixels) {
    if (contains(box, p.value)) sum += p.count;
  }
  return sum;
}

bool boxes_overlap(const ColorBox& a, const ColorBox& b) {
  for (std::size_t c = 0; c < 3; ++c) {
    if (a.low[c] > b.high[c] || b.low[c] > a.high[c]) return false;
  }
  return true;
}

ColorBox core_of(const std::vector<ColorCount>& pixels, ColorId color, double tail) {
  ColorBox box;
  box.color = color;
  for (std::size_t c = 0; c < 3; ++c) {
    box.low[c] = quantile(pixels, c, tail);
    box.high[c] = std::max(box.low[c], quantile(pixels, c, 1.0 - tail));
  }
  return box;
}

int side_value(const ColorBox& box, std::size_t side) { return side % 2 == 0 ? box.low[side / 2] : box.high[side / 2]; }

void set_side(ColorBox& box, std::size_t side, int value) {
  (side % 2 == 0 ? box.low : box.high)[side / 2] = static_cast<std::uint8_t>(std::clamp(value, 0, 255));
}

ColorBoxes initial_boxes(const LearningInput& input, const LearningRules& rules) {
  const double background = total(input.background);
  std::vector<Cluster> clusters;
  for (std::size_t c = 0; c < input.colors.size(); ++c) {
    Cluster cluster{c, input.colors[c].pixels,
                    core_of(input.colors[c].pixels, static_cast<ColorId>(c + 1), rules.core_tail), 0.0};
    cluster.conflict = conflict_of(input, rules, cluster.core, background);
    clusters.push_back(std::move(cluster));
  }
  // A smaller conflict is not worth a cut: below a hundredth of another color, the percentiles themselves are less
  // accurate.
  constexpr double kConflict = 0.01, kWorthwhile = 0.7;
  std::vector<bool> settled(clusters.size(), false);
  while (clusters.size() < kMaxColorBoxes) {
    std::size_t worst = clusters.size();
    for (std::size_t i = 0; i < clusters.size(); ++i) {
      const auto boxes = static_cast<std::size_t>(std::count_if(
          clusters.begin(), clusters.end(), [&](const Cluster& c) { return c.color == clusters[i].color; }));
      if (settled[i] || clusters[i].conflict < kConflict || boxes >= rules.boxes_a_color) continue;
      if (worst == clusters.size() || clusters[i].conflict > clusters[worst].conflict) worst = i;
    }
    if (worst == clusters.size()) break;
    auto halves = best_split(input, rules, clusters[worst], background);
    if (!halves || halves->conflict > kWorthwhile * clusters[worst].conflict) {
      settled[worst] = true;
      continue;
    }
    clusters[worst] = std::move(halves->low);
    clusters.push_back(std::move(halves->high));
    settled.push_back(false);
  }
  std::stable_sort(clusters.begin(), clusters.end(),
                   [](const Cluster& a, const Cluster& b) { return a.color < b.color; });
  ColorBoxes boxes;
  for (const Cluster& cluster : clusters) boxes.push_back(cluster.core);
  return boxes;
}

}  // namespace touchline::calibrate
