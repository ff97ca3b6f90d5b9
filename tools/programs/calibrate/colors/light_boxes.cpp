#include "tools/programs/calibrate/colors/light_boxes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "core/color_space.h"
#include "tools/programs/calibrate/colors/initial_boxes.h"

namespace touchline::calibrate {
namespace {

// Approximates the sRGB transfer function.
constexpr double kPaintGamma = 2.2;
// Light on a field: factors of the brightness, its tint (factor of red, and inverse factor of blue), and glare as a
// share of white.
constexpr std::array kLitGains = {0.3, 0.38, 0.46, 0.55, 0.65, 0.77, 0.9, 1.05, 1.25, 1.45, 1.7};
constexpr std::array kLitTints = {0.8, 1.0, 1.25};
constexpr std::array kLitGlares = {0.0, 0.02, 0.04, 0.07, 0.1, 0.14, 0.18};
// Standard deviations of the logarithms of gain and tint; mean of the glare.
constexpr double kLogGainSigma = 0.5, kLogTintSigma = 0.2, kMeanLitGlare = 0.06;
// Number of pixels that represent all pixels of a color.
constexpr std::size_t kShades = 16;
// Least share of a color's light that a further box must add, and the largest number of further boxes per color.
constexpr double kMinGain = 0.015;
constexpr std::size_t kMaxAdded = 4;
// Least likelihood ratio between a box's own color and any other color, for other colors that are found by their boxes,
// and for identification colors, which are not.
constexpr double kMinOdds = 10.0, kMinOddsOfIdentification = 2.0;
// Least distance of a box from gray, in levels.
constexpr int kFromGray = 12;

// Boxes are evaluated on a grid with cells of this many levels.
constexpr int kCell = 4, kCells = 256 / kCell;

// First and last cell of each channel.
struct CellBox {
  std::array<int, 3> low{}, high{};
};

ColorBox levels_of(const CellBox& box, ColorId color) {
  ColorBox out;
  out.color = color;
  for (std::size_t c = 0; c < 3; ++c) {
    out.low[c] = static_cast<std::uint8_t>(box.low[c] * kCell);
    out.high[c] = static_cast<std::uint8_t>(box.high[c] * kCell + kCell - 1);
  }
  return out;
}

// Prefix sums of weights of colors: each is the sum over a box of cells from the origin, so the sum over any box needs
// eight values.
class WeightVolume {
 public:
  WeightVolume() : sums_(static_cast<std::size_t>(kCells + 1) * (kCells + 1) * (kCells + 1)) {}

  void add(const Channels& value, double weight) {
    sums_[index(value[0] / kCell + 1, value[1] / kCell + 1, value[2] / kCell + 1)] += weight;
    total_ += weight;
  }
  void sum_up() {
    for (int axis = 0; axis < 3; ++axis) {
      for (int a = 1; a <= kCells; ++a) {
        for (int b = 1; b <= kCells; ++b) {
          for (int c = 1; c <= kCells; ++c) {
            sums_[index(a, b, c)] += sums_[index(a - (axis == 0), b - (axis == 1), c - (axis == 2))];
          }
        }
      }
    }
  }
  [[nodiscard]] double in(const CellBox& box) const {
    const auto at = [&](bool a, bool b, bool c) {
      return sums_[index(a ? box.high[0] + 1 : box.low[0], b ? box.high[1] + 1 : box.low[1],
                         c ? box.high[2] + 1 : box.low[2])];
    };
    return at(true, true, true) - at(false, true, true) - at(true, false, true) - at(true, true, false) +
           at(false, false, true) + at(false, true, false) + at(true, false, false) - at(false, false, false);
  }
  [[nodiscard]] double total() const { return total_; }

 private:
  static std::size_t index(int a, int b, int c) {
    return (static_cast<std::size_t>(a) * (kCells + 1) + static_cast<std::size_t>(b)) * (kCells + 1) +
           static_cast<std::size_t>(c);
  }
  std::vector<double> sums_;
  double total_ = 0;
};

struct LitPixel {
  Channels value{};
  double weight = 0;
};
// Pixels of a color in one light.
using LitShades = std::vector<LitPixel>;

// Selects pixels that represent all pixels of a color.
std::vector<Channels> shades_of(const std::vector<ColorCount>& pixels) {
  const double all = total(pixels);
  std::vector<Channels> out;
  double sum = 0;
  for (const ColorCount& p : pixels) {
    sum += p.count;
    while (out.size() < kShades && sum > all * (static_cast<double>(out.size()) + 0.5) / kShades)
      out.push_back(p.value);
  }
  return out;
}

// Adds a color in every light, for a camera that clips at `white`.
void add_lit(const std::vector<Channels>& shades, ColorSpace space, int white, std::vector<LitShades>& out) {
  const double brightest = std::pow(white / 255.0, kPaintGamma);
  for (const double gain : kLitGains) {
    for (const double tint : kLitTints) {
      for (const double glare : kLitGlares) {
        const double weight = std::exp(-std::pow(std::log(gain) / kLogGainSigma, 2) / 2 -
                                       std::pow(std::log(tint) / kLogTintSigma, 2) / 2 - glare / kMeanLitGlare);
        const std::array<double, 3> factor = {gain * tint, gain, gain / tint};
        LitShades here;
        for (const Channels& shade : shades) {
          const Channels rgb = to_rgb8(shade, space);
          std::array<double, 3> seen{};
          for (std::size_t c = 0; c < 3; ++c) {
            const double linear = factor[c] * std::pow(rgb[c] / 255.0, kPaintGamma) + glare;
            seen[c] = 255 * std::pow(std::min(linear, brightest), 1 / kPaintGamma);
          }
          here.push_back({channels_of(seen, space), weight});
        }
        out.push_back(std::move(here));
      }
    }
  }
}

// Computes each color in every light; the weights of a color add up to one. The brightest value in the pictures may be
// the value at which the camera clips.
std::vector<LitShades> lit(const LearningInput& input, const std::vector<ColorCount>& pixels) {
  const std::vector<Channels> shades = shades_of(pixels);
  std::vector<LitShades> out;
  for (const int white : {input.brightest, 255}) add_lit(shades, input.space, white, out);
  double sum = 0;
  for (const LitShades& here : out) {
    for (const LitPixel& pixel : here) sum += pixel.weight;
  }
  for (LitShades& here : out) {
    for (LitPixel& pixel : here) pixel.weight /= sum;
  }
  return out;
}

class Widening {
 public:
  Widening(const LearningInput& input, const LearningRules& rules, ColorBoxes& boxes)
      : input_(input), rules_(rules), boxes_(boxes), real_(input.colors.size()), lit_volume_(input.colors.size()) {
    for (const ColorCount& p : input.background) background_.add(p.value, p.count);
    background_.sum_up();
    for (const ColorCount& p : input.things) things_.add(p.value, p.count);
    things_.sum_up();
    for (std::size_t c = 0; c < input.colors.size(); ++c) {
      for (const ColorCount& p : input.colors[c].pixels) real_[c].add(p.value, p.count);
      real_[c].sum_up();
      lit_.push_back(lit(input, input.colors[c].pixels));
      for (const LitShades& shades : lit_.back()) {
        for (const LitPixel& pixel : shades) lit_volume_[c].add(pixel.value, pixel.weight);
      }
      lit_volume_[c].sum_up();
    }
  }

  void widen(std::size_t color) {
    for (std::size_t added = 0; added < kMaxAdded && !boxes_.full(); ++added) {
      WeightVolume missing;
      for (const LitShades& shades : lit_[color]) {
        for (const LitPixel& pixel : shades) {
          if (!is_covered(color, pixel.value)) missing.add(pixel.value, pixel.weight);
        }
      }
      missing.sum_up();
      std::optional<CellBox> best;
      double most = kMinGain;
      for (const LitShades& shades : lit_[color]) {
        std::optional<CellBox> box = core_in_light(color, shades);
        if (!box) continue;
        grow(color, missing, *box);
        const double gain = missing.in(*box);
        if (gain <= most) continue;
        most = gain;
        best = box;
      }
      if (!best) return;
      add_margin(color, *best);
      boxes_.push_back(levels_of(*best, static_cast<ColorId>(color + 1)));
    }
  }

 private:
  [[nodiscard]] bool is_covered(std::size_t color, const Channels& value) const {
    return std::any_of(boxes_.begin(), boxes_.end(),
                       [&](const ColorBox& box) { return box.color == color + 1 && contains(box, value); });
  }

  // Returns the box around the pixels in this light, without the outermost ones; empty if this box is not allowed.
  [[nodiscard]] std::optional<CellBox> core_in_light(std::size_t color, const LitShades& shades) const {
    CellBox box;
    for (std::size_t c = 0; c < 3; ++c) {
      std::vector<int> values;
      for (const LitPixel& pixel : shades) values.push_back(pixel.value[c] / kCell);
      std::sort(values.begin(), values.end());
      box.low[c] = values[values.size() / 8];
      box.high[c] = values[values.size() - 1 - values.size() / 8];
    }
    return is_allowed(color, box) ? std::optional<CellBox>(box) : std::nullopt;
  }

  [[nodiscard]] bool is_allowed(std::size_t color, const CellBox& box) const {
    if (background_.in(box) > rules_.background_share * background_.total()) return false;
    if (things_.in(box) > rules_.other_share * things_.total()) return false;
    const ColorBox levels = levels_of(box, static_cast<ColorId>(color + 1));
    if (contains_gray(levels)) return false;
    const double own = lit_volume_[color].in(box);
    for (std::size_t c = 0; c < input_.colors.size(); ++c) {
      if (c == color) continue;
      if (real_[c].in(box) > rules_.other_share * real_[c].total()) return false;
      const bool is_identification =
          input_.colors[c].use == ColorUse::kIdentification && input_.colors[color].use == ColorUse::kTeam;
      const double odds = is_identification ? kMinOddsOfIdentification : kMinOdds;
      if (odds * lit_volume_[c].in(box) > own) return false;
    }
    return std::none_of(boxes_.begin(), boxes_.end(), [&](const ColorBox& other) {
      return other.color != levels.color && boxes_overlap(other, levels);
    });
  }

  // Returns whether the box contains gray or nearly gray, the colors of paper, lines and worn floor.
  [[nodiscard]] bool contains_gray(const ColorBox& box) const {
    if (input_.space == ColorSpace::kRgb) {
      return *std::max_element(box.low.begin(), box.low.end()) <
             *std::min_element(box.high.begin(), box.high.end()) + kFromGray;
    }
    constexpr int kNoChroma = 128;
    return std::all_of(box.low.begin() + 1, box.low.end(), [](int low) { return low <= kNoChroma + kFromGray / 2; }) &&
           std::all_of(box.high.begin() + 1, box.high.end(),
                       [](int high) { return high >= kNoChroma - kFromGray / 2; });
  }

  static bool move_side(CellBox& box, std::size_t side, int cells) {
    int& value = side % 2 == 0 ? box.low[side / 2] : box.high[side / 2];
    value += side % 2 == 0 ? -cells : cells;
    return value >= 0 && value < kCells;
  }

  // Moves sides outwards as long as the box gains weight, first the side that gains most for its width.
  void grow(std::size_t color, const WeightVolume& missing, CellBox& box) const {
    constexpr int kFarthest = 6;
    double now = missing.in(box);
    for (;;) {
      CellBox best = box;
      double most = 0, gained = now;
      for (std::size_t side = 0; side < kSides; ++side) {
        for (int cells = 1; cells <= kFarthest; ++cells) {
          CellBox tried = box;
          if (!move_side(tried, side, cells) || !is_allowed(color, tried)) break;
          const double gain = missing.in(tried);
          if ((gain - now) / cells <= most) continue;
          most = (gain - now) / cells;
          gained = gain;
          best = tried;
        }
      }
      if (most <= 1e-9) return;
      box = best;
      now = gained;
    }
  }

  // Adds a margin for noise, and for light between the computed steps.
  void add_margin(std::size_t color, CellBox& box) const {
    for (std::size_t side = 0; side < kSides; ++side) {
      CellBox wider = box;
      if (move_side(wider, side, 1) && is_allowed(color, wider)) box = wider;
    }
  }

  const LearningInput& input_;
  const LearningRules& rules_;
  ColorBoxes& boxes_;
  WeightVolume background_, things_;
  std::vector<WeightVolume> real_, lit_volume_;  // for each color: its pixels, and its pixels in every light
  std::vector<std::vector<LitShades>> lit_;
};

}  // namespace

ColorBoxes light_boxes(const LearningInput& input, const LearningRules& rules, const ColorBoxes& known, ColorUse use) {
  ColorBoxes boxes = known;
  Widening widening(input, rules, boxes);
  for (std::size_t c = 0; c < input.colors.size(); ++c) {
    if (input.colors[c].use == use) widening.widen(c);
  }
  ColorBoxes added;
  for (std::size_t i = known.size(); i < boxes.size(); ++i) added.push_back(boxes[i]);
  return added;
}

}  // namespace touchline::calibrate
