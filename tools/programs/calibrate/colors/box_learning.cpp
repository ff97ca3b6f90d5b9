#include "tools/programs/calibrate/colors/box_learning.h"

#include <algorithm>
#include <map>

#include "core/adaptation.h"
#include "tools/programs/calibrate/colors/box_separation.h"
#include "tools/programs/calibrate/colors/initial_boxes.h"
#include "tools/programs/calibrate/colors/light_boxes.h"

namespace touchline::calibrate {
namespace {

// A growing box. Indices of its sides: channel * 2 + (0 low, 1 high).
struct Growing {
  ColorBox box;
  ColorBox core;
  std::array<bool, 6> stopped{};
  double caught_background = 0;
  std::vector<double> caught_other;
};

class Grower {
 public:
  Grower(const LearningInput& input, const LearningRules& rules) : input_(input), rules_(rules) {
    for (const ColorCount& c : input.background) background_total_ += c.count;
    for (const ColorSamples& color : input.colors) color_total_.push_back(total(color.pixels));
  }

  // `fixed`: further boxes, which do not grow.
  void grow(ColorBoxes& boxes, const ColorBoxes& fixed) const {
    std::vector<Growing> growing;
    for (const ColorBox& box : boxes) growing.push_back({box, box, {}, 0.0, std::vector<double>(color_total_.size())});
    for (const ColorBox& box : fixed) {
      growing.push_back({box, box, {}, 0.0, {}});
      growing.back().stopped.fill(true);
    }
    bool any = true;
    while (any) {
      any = false;
      for (Growing& g : growing) {
        for (std::size_t side = 0; side < 6; ++side) {
          if (!g.stopped[side]) any |= step(g, side, growing);
        }
      }
    }
    for (std::size_t i = 0; i < boxes.size(); ++i) boxes[i] = growing[i].box;
  }

 private:
  // Moves a side by one level, or stops it.
  bool step(Growing& g, std::size_t side, const std::vector<Growing>& all) const {
    const int next = side_value(g.box, side) + outwards(side);
    g.stopped[side] = true;
    if (next < 0 || next > 255) return false;
    const ColorBox slab = slab_at(g.box, side, next);
    const bool touches = std::any_of(all.begin(), all.end(), [&](const Growing& other) {
      return other.box.color != g.box.color && boxes_overlap(other.box, slab);
    });
    if (touches || std::abs(next - side_value(g.core, side)) > rules_.max_margin) {
      keep_away_from_background(g, side);
      return false;
    }
    if (!take(g, slab)) {
      // Keeps half of the distance to the samples, so that both colors have the same tolerance against changes.
      const int core = side_value(g.core, side);
      set_side(g.box, side, core + (side_value(g.box, side) - core) / 2);
      return false;
    }
    g.stopped[side] = false;
    set_side(g.box, side, next);
    return true;
  }

  // Adds the samples in the slab to the samples inside the box, unless they would become too many.
  bool take(Growing& g, const ColorBox& slab) const {
    const double background = count_in(input_.background, slab);
    bool met = g.caught_background + background > rules_.background_share * background_total_;
    std::vector<double> other(color_total_.size());
    for (std::size_t c = 0; c < color_total_.size(); ++c) {
      if (c + 1 == g.box.color) continue;
      other[c] = count_in(input_.colors[c].pixels, slab);
      met |= g.caught_other[c] + other[c] > rules_.other_share * color_total_[c];
    }
    if (met) return false;
    g.caught_background += background;
    for (std::size_t c = 0; c < other.size(); ++c) g.caught_other[c] += other[c];
    return true;
  }

  // Moves a side inwards, unless it has met samples: background may lie directly behind it, and boxes move while the
  // light changes. Other colors have boxes of their own.
  void keep_away_from_background(Growing& g, std::size_t side) const {
    const int core = side_value(g.core, side), margin = std::abs(side_value(g.box, side) - core);
    double caught = g.caught_background;
    for (int distance = margin; distance < std::min(2 * margin, margin + room_); ++distance) {
      const int next = core + outwards(side) * (distance + 1);
      if (next < 0 || next > 255) return;
      caught += count_in(input_.background, slab_at(g.box, side, next));
      if (caught <= rules_.background_share * background_total_) continue;
      set_side(g.box, side, core + outwards(side) * std::max(distance / 2, distance - room_));
      return;
    }
  }

  static int outwards(std::size_t side) { return side % 2 == 0 ? -1 : 1; }
  // Returns the plane that the side sweeps if it is at `value`.
  static ColorBox slab_at(ColorBox box, std::size_t side, int value) {
    set_side(box, side, value);
    set_side(box, side ^ 1, value);
    return box;
  }

  const LearningInput& input_;
  const LearningRules& rules_;
  const int room_ = static_cast<int>(AdaptationParameters{}.max_shift);  // levels by which boxes may move in a game
  double background_total_ = 0;
  std::vector<double> color_total_;
};

int core_distance(const ColorBoxes& cores, std::size_t first, std::size_t second) {
  int smallest = 255;
  for (const ColorBox& a : cores) {
    for (const ColorBox& b : cores) {
      if (a.color != first + 1 || b.color != second + 1) continue;
      int widest = -255;
      for (std::size_t c = 0; c < 3; ++c) {
        widest = std::max({widest, static_cast<int>(a.low[c]) - b.high[c], static_cast<int>(b.low[c]) - a.high[c]});
      }
      smallest = std::min(smallest, widest);
    }
  }
  return smallest;
}

}  // namespace

std::vector<ColorCount> count_colors(const std::vector<Channels>& pixels) {
  std::map<Channels, std::uint32_t> counts;
  for (const Channels& p : pixels) ++counts[p];
  std::vector<ColorCount> out;
  out.reserve(counts.size());
  for (const auto& [value, count] : counts) out.push_back({value, count});
  return out;
}

Result<LearnedColors> learn_boxes(const LearningInput& input, const LearningRules& rules) {
  if (input.colors.empty() || input.colors.size() > kMaxColors) {
    return failure(ErrorCode::kOutOfRange, "there are %zu colors; 1 to %zu are possible", input.colors.size(),
                   kMaxColors);
  }
  for (const ColorSamples& color : input.colors) {
    if (color.pixels.empty()) {
      return failure(ErrorCode::kNotFound, "color %s has no pixels", color.name.c_str());
    }
  }
  LearnedColors out;
  ColorBoxes cores = initial_boxes(input, rules);
  for (std::size_t i = 0; i < input.colors.size(); ++i) {
    for (std::size_t j = i + 1; j < input.colors.size(); ++j) {
      out.margins.push_back({i, j, core_distance(cores, i, j)});
    }
  }
  std::sort(out.margins.begin(), out.margins.end(),
            [](const PairMargin& a, const PairMargin& b) { return a.levels < b.levels; });

  std::vector<double> before(input.colors.size()), after(input.colors.size());
  const auto covered = [&](std::vector<double>& share) {
    for (std::size_t c = 0; c < share.size(); ++c) {
      share[c] = 0;
      for (const ColorBox& box : cores) {
        if (box.color == c + 1) share[c] += count_in(input.colors[c].pixels, box) / total(input.colors[c].pixels);
      }
    }
  };
  covered(before);
  carve_background(input, rules, cores);
  TOUCHLINE_TRY(separate_boxes(input, rules, cores));
  covered(after);
  for (std::size_t c = 0; c < before.size(); ++c) out.cut_share.push_back(before[c] - after[c]);
  const Grower grower(input, rules);
  ColorBoxes known = cores;
  grower.grow(known, {});
  for (std::size_t i = 0; i < known.size(); ++i) {
    if (input.colors[known[i].color - 1U].use == ColorUse::kIdentification) known[i] = cores[i];
  }
  const ColorBoxes in_other_light = light_boxes(input, rules, known, ColorUse::kTeam);
  grower.grow(cores, in_other_light);
  out.boxes = cores;
  for (const ColorBox& box : in_other_light) out.boxes.push_back(box);
  // Boxes of the ball come after all others have grown, and get the space that is left.
  for (const ColorBox& box : light_boxes(input, rules, out.boxes, ColorUse::kBall)) out.boxes.push_back(box);
  std::stable_sort(out.boxes.begin(), out.boxes.end(),
                   [](const ColorBox& a, const ColorBox& b) { return a.color < b.color; });
  return out;
}

}  // namespace touchline::calibrate
