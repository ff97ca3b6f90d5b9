#include "tools/programs/calibrate/colors/box_separation.h"

#include <algorithm>
#include <vector>

#include "tools/programs/calibrate/colors/initial_boxes.h"

namespace touchline::calibrate {
namespace {

// Smaller pieces are edges of patches, not shades of the color.
constexpr double kMinShare = 0.015;

struct Piece {
  ColorBox box;
  double share = 0;
};

ColorBox common_part(const ColorBox& a, const ColorBox& b) {
  ColorBox common = a;
  for (std::size_t c = 0; c < 3; ++c) {
    common.low[c] = std::max(a.low[c], b.low[c]);
    common.high[c] = std::min(a.high[c], b.high[c]);
  }
  return common;
}

double share_in(const LearningInput& input, const ColorBox& box, ColorId color) {
  const auto& pixels = input.colors[color - 1U].pixels;
  return count_in(pixels, box) / total(pixels);
}

// Cuts slabs off the box, the slab with most pixels first, until only the common part is left; each slab shrinks to its
// own pixels.
std::vector<Piece> without(ColorBox rest, const ColorBox& common, const LearningInput& input,
                           const LearningRules& rules) {
  const auto& pixels = input.colors[rest.color - 1U].pixels;
  std::vector<Piece> pieces;
  while (true) {
    Piece best;
    std::size_t best_side = kSides;
    for (std::size_t side = 0; side < kSides; ++side) {
      if (side_value(rest, side) == side_value(common, side)) continue;
      ColorBox slab = rest;
      set_side(slab, side ^ 1, side_value(common, side) + (side % 2 == 0 ? -1 : 1));
      const double share = share_in(input, slab, rest.color);
      if (best_side == kSides || share > best.share) {
        best = {slab, share};
        best_side = side;
      }
    }
    if (best_side == kSides) return pieces;
    set_side(rest, best_side, side_value(common, best_side));
    if (best.share < kMinShare) continue;
    std::vector<ColorCount> own;
    std::copy_if(pixels.begin(), pixels.end(), std::back_inserter(own),
                 [&](const ColorCount& p) { return contains(best.box, p.value); });
    best.box = core_of(own, rest.color, rules.core_tail);
    pieces.push_back(best);
  }
}

std::size_t boxes_of(const ColorBoxes& boxes, ColorId color) {
  return static_cast<std::size_t>(
      std::count_if(boxes.begin(), boxes.end(), [&](const ColorBox& b) { return b.color == color; }));
}

void erase(ColorBoxes& boxes, std::size_t index) {
  for (std::size_t i = index; i + 1 < boxes.size(); ++i) boxes[i] = boxes[i + 1];
  boxes.pop_back();
}

}  // namespace

Result<void> separate_boxes(const LearningInput& input, const LearningRules& rules, ColorBoxes& cores) {
  std::size_t first = 0, second = 0;
  while (overlapping_boxes(cores, first, second)) {
    const ColorBox common = common_part(cores[first], cores[second]);
    const bool first_gives = share_in(input, common, cores[first].color) < share_in(input, common, cores[second].color);
    const std::size_t giver = first_gives ? first : second;
    const ColorBox given = cores[giver];
    std::vector<Piece> pieces = without(given, common, input, rules);
    const ColorId taker = cores[first_gives ? second : first].color;
    erase(cores, giver);  // The remaining pieces cover less than before, so the loop ends.
    const std::size_t room = std::min(rules.boxes_a_color - std::min(rules.boxes_a_color, boxes_of(cores, given.color)),
                                      kMaxColorBoxes - cores.size());
    std::sort(pieces.begin(), pieces.end(), [](const Piece& a, const Piece& b) { return a.share > b.share; });
    for (std::size_t i = 0; i < std::min(std::max<std::size_t>(1, room), pieces.size()); ++i) {
      cores.push_back(pieces[i].box);
    }
    if (boxes_of(cores, given.color) == 0) {
      return failure(ErrorCode::kInconsistent,
                     "%s and %s have the same color in these pictures: replace one of them, or improve the lighting",
                     input.colors[given.color - 1U].name.c_str(), input.colors[taker - 1U].name.c_str());
    }
  }
  std::stable_sort(cores.begin(), cores.end(), [](const ColorBox& a, const ColorBox& b) { return a.color < b.color; });
  return {};
}

void carve_background(const LearningInput& input, const LearningRules& rules, ColorBoxes& cores) {
  const double allowed = rules.carve_share * total(input.background);
  for (ColorBox& box : cores) {
    std::vector<ColorCount> own, floor;
    const auto in_box = [&](const ColorCount& p) { return contains(box, p.value); };
    const auto& pixels = input.colors[box.color - 1U].pixels;
    std::copy_if(pixels.begin(), pixels.end(), std::back_inserter(own), in_box);
    std::copy_if(input.background.begin(), input.background.end(), std::back_inserter(floor), in_box);
    const double least = (1.0 - rules.most_carved) * total(own);
    double own_left = total(own), floor_left = total(floor);
    while (floor_left > allowed) {
      ColorBox best = box;
      double best_gain = 0, best_own = 0, best_floor = 0;
      for (std::size_t side = 0; side < kSides; ++side) {
        // Tries several levels, because the outermost one often contains no pixels.
        for (int step = 1; step <= 16; ++step) {
          ColorBox smaller = box;
          const int value = side_value(box, side) + (side % 2 == 0 ? step : -step);
          if (side % 2 == 0 ? value > side_value(box, side + 1) : value < side_value(box, side - 1)) break;
          set_side(smaller, side, value);
          const double own_now = count_in(own, smaller);
          if (own_now < least) break;
          const double floor_now = count_in(floor, smaller);
          const double gain = (floor_left - floor_now) / floor_left / ((own_left - own_now) / own_left + 0.01);
          if (floor_now < floor_left && gain > best_gain) {
            best_gain = gain;
            best = smaller;
            best_own = own_now;
            best_floor = floor_now;
          }
        }
      }
      if (best_gain <= 1.0) break;  // the cut would remove more of the color than of the background
      box = best;
      own_left = best_own;
      floor_left = best_floor;
    }
  }
}

}  // namespace touchline::calibrate
