#include "core/color/box_shift.h"

#include <algorithm>
#include <cmath>

namespace touchline {
namespace {

int levels_between(const ColorBox& a, const ColorBox& b, std::size_t channel) {
  return std::max(int{a.low[channel]} - b.high[channel], int{b.low[channel]} - a.high[channel]) - 1;
}

// Returns the channel in which two boxes are farthest apart. In this channel, disjoint boxes do not overlap.
std::size_t separating_channel(const ColorBox& a, const ColorBox& b) {
  std::size_t best = 0;
  for (std::size_t channel = 1; channel < 3; ++channel) {
    if (levels_between(a, b, channel) > levels_between(a, b, best)) best = channel;
  }
  return best;
}

// Ends both boxes halfway through their overlap. Returns false and changes nothing if one of them would become empty.
bool separate(ColorBox& below, ColorBox& above, std::size_t channel) {
  const int middle = (int{below.high[channel]} + above.low[channel]) / 2;
  if (middle < below.low[channel] || middle + 1 > above.high[channel]) return false;
  below.high[channel] = static_cast<std::uint8_t>(middle);
  above.low[channel] = static_cast<std::uint8_t>(middle + 1);
  return true;
}

}  // namespace

Status BoxShift::configure(const ColorBoxes& boxes, float max_levels) {
  if (Status s = check(boxes); !s.ok()) return s;
  if (!(max_levels >= 0.0f)) return ErrorCode::kOutOfRange;
  boxes_ = boxes;
  max_levels_ = max_levels;
  reset();
  return {};
}

void BoxShift::reset() {
  shift_.fill({});
  known_.fill({});
}

std::array<float, 3> BoxShift::of(ColorId color) const {
  std::array<float, 3> sum{};
  for (std::size_t channel = 0; channel < 3; ++channel) {
    sum[channel] = std::clamp(known_[color][channel] + shift_[color][channel], -max_levels_, max_levels_);
  }
  return sum;
}

void BoxShift::observe(ColorId color, const std::array<float, 3>& deviation, float step) {
  const std::array<float, 3> whole = of(color);
  for (std::size_t channel = 0; channel < 3; ++channel) {
    float& shift = shift_[color][channel];
    const float limited = std::clamp(deviation[channel] - whole[channel], -kMaxStep_levels, kMaxStep_levels);
    shift = std::clamp(shift + step * limited, -max_levels_, max_levels_);
  }
}

ColorBoxes BoxShift::moved() const {
  HeldColors held{};
  // Each attempt holds at least one more color in place, so the loop ends.
  for (std::size_t tries = 0; tries <= kMaxColors; ++tries) {
    ColorBoxes moved = moved_except(held);
    if (separate_all(moved, held)) return moved;
  }
  return boxes_;
}

// Returns the boxes moved by whole levels, except those of the held colors.
ColorBoxes BoxShift::moved_except(const HeldColors& held) const {
  ColorBoxes moved = boxes_;
  for (ColorBox& box : moved) {
    if (held[box.color]) continue;
    const std::array<float, 3> shift = of(box.color);
    for (std::size_t channel = 0; channel < 3; ++channel) {
      const int by = static_cast<int>(std::lround(shift[channel]));
      // A side at the end of the scale stays there, so that saturated pixels keep their class.
      if (box.low[channel] > 0) {
        box.low[channel] = static_cast<std::uint8_t>(std::clamp(box.low[channel] + by, 1, 255));
      }
      if (box.high[channel] < 255) {
        box.high[channel] = static_cast<std::uint8_t>(std::clamp(box.high[channel] + by, 0, 254));
      }
      if (box.low[channel] > box.high[channel]) {
        const ColorBox& former = boxes_[static_cast<std::size_t>(&box - moved.begin())];
        box.low[channel] = former.low[channel];
        box.high[channel] = former.high[channel];
      }
    }
  }
  return moved;
}

// Makes overlapping boxes of two colors end halfway through their overlap. Returns false if one box would become empty,
// and then marks both colors as held.
bool BoxShift::separate_all(ColorBoxes& moved, HeldColors& held) const {
  for (std::size_t a = 0; a < boxes_.size(); ++a) {
    for (std::size_t b = a + 1; b < boxes_.size(); ++b) {
      const std::size_t channel = separating_channel(boxes_[a], boxes_[b]);
      if (moved[a].color == moved[b].color || levels_between(boxes_[a], boxes_[b], channel) < 0) continue;
      if (levels_between(moved[a], moved[b], separating_channel(moved[a], moved[b])) >= 0) continue;
      const bool a_below = boxes_[a].high[channel] < boxes_[b].low[channel];
      ColorBox &below = moved[a_below ? a : b], &above = moved[a_below ? b : a];
      if (separate(below, above, channel)) continue;
      held[below.color] = held[above.color] = true;
      return false;
    }
  }
  return true;
}

}  // namespace touchline
