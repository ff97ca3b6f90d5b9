#include "core/color/background_box.h"

#include <algorithm>

namespace touchline {
namespace {

// Prior of a channel's background values.
struct Expectation {
  std::uint8_t anchor;  // value that is always in the box
  int extent;           // distance from the anchor at which the weight is least; 0: all weights are equal

  [[nodiscard]] std::uint32_t weight(std::uint32_t value) const {
    const int off = static_cast<int>(value) - anchor;
    return static_cast<std::uint32_t>(std::max(1, extent - std::max(off, -off)));
  }
  [[nodiscard]] std::uint32_t weight(ValueRange range) const {
    std::uint32_t sum = 0;
    for (std::uint32_t value = range.low; value <= range.high; ++value) sum += weight(value);
    return sum;
  }
};
using Expectations = std::array<Expectation, 3>;

Expectations expected_of(ColorSpace space, const TypicalBackground& background) {
  constexpr int kMaxChroma = 64;
  constexpr int kUnevenness = 32;  // levels by which light and noise change the values of a floor
  Expectations expected{};
  for (std::size_t c = 0; c < 3; ++c) {
    const bool is_chroma = is_yuv(space) && c > 0;
    expected[c] = background ? Expectation{(*background)[c], kUnevenness}
                             : Expectation{black_value(space, c), is_chroma ? kMaxChroma : 0};
  }
  return expected;
}

Expectations expected_of_pale(ColorSpace space, const TypicalBackground& background) {
  constexpr int kUnevenness = 16;  // levels by which light and noise change the chroma of a floor
  Expectations expected{};
  for (std::size_t c = 0; c < 3; ++c) {
    expected[c] = {background ? (*background)[c] : black_value(space, c), c == 0 ? 0 : kUnevenness};
  }
  return expected;
}

struct Candidate {
  ValueRange range;
  std::uint64_t weight = 0;
};
using Bounds = FixedVector<std::uint8_t, kMaxColorBoxes + 1>;

bool overlap(const ColorBox& box, std::size_t channel, ValueRange range) {
  return box.low[channel] <= range.high && box.high[channel] >= range.low;
}

// Finds the widest range around the anchor that overlaps no box. The weight is 0 if there is no such range.
Candidate widest(const ColorBoxes& boxes, const Expectation& expected, std::size_t channel) {
  const std::uint8_t anchor = expected.anchor;
  ValueRange range = {0, 255};
  for (const ColorBox& box : boxes) {
    if (box.low[channel] > anchor) {
      range.high = std::min<std::uint8_t>(range.high, static_cast<std::uint8_t>(box.low[channel] - 1));
    } else if (box.high[channel] < anchor) {
      range.low = std::max<std::uint8_t>(range.low, static_cast<std::uint8_t>(box.high[channel] + 1));
    } else {
      return {};
    }
  }
  return {range, expected.weight(range)};
}

// Collects the bounds that the best range of the channel can have: next to a box, or at the end of the scale.
void find_bounds(const ColorBoxes& boxes, std::uint8_t anchor, std::size_t channel, Bounds& low, Bounds& high) {
  low.push_back(0);
  high.push_back(255);
  for (const ColorBox& box : boxes) {
    if (box.low[channel] > anchor) high.push_back(static_cast<std::uint8_t>(box.low[channel] - 1));
    if (box.high[channel] < anchor) low.push_back(static_cast<std::uint8_t>(box.high[channel] + 1));
  }
  const auto make_unique = [](Bounds& bounds) {
    std::sort(bounds.begin(), bounds.end());
    bounds.resize(static_cast<std::size_t>(std::unique(bounds.begin(), bounds.end()) - bounds.begin()));
  };
  make_unique(low);
  make_unique(high);
}

// Calls `use` with every range that the channel can have, and with the boxes that overlap it.
template <class Use>
void for_each_range(const ColorBoxes& boxes, const Expectation& expected, std::size_t channel, Use use) {
  Bounds lows, highs;
  find_bounds(boxes, expected.anchor, channel, lows, highs);
  for (const std::uint8_t low : lows) {
    for (const std::uint8_t high : highs) {
      const ValueRange range = {low, high};
      ColorBoxes met;
      for (const ColorBox& box : boxes) {
        if (overlap(box, channel, range)) met.push_back(box);
      }
      use(Candidate{range, expected.weight(range)}, met);
    }
  }
}

// Returns the box with the greatest weight.
BackgroundBox best_box(const ColorBoxes& boxes, const Expectations& expected) {
  BackgroundBox best;
  std::uint64_t most = 0;
  for_each_range(boxes, expected[0], 0, [&](const Candidate& first, const ColorBoxes& met_first) {
    for_each_range(met_first, expected[1], 1, [&](const Candidate& second, const ColorBoxes& met_second) {
      // The best range of the third channel follows from the other two.
      const Candidate third = widest(met_second, expected[2], 2);
      const std::uint64_t weight = first.weight * second.weight * third.weight;
      if (weight <= most) return;
      most = weight;
      best = {{first.range.low, second.range.low, third.range.low},
              {first.range.high, second.range.high, third.range.high},
              true};
    });
  });
  return best;
}

}  // namespace

BackgroundBox find_background_box(const ColorBoxes& boxes, ColorSpace space, const TypicalBackground& background) {
  return best_box(boxes, expected_of(space, background));
}

BackgroundBox find_pale_box(const ColorBoxes& boxes, ColorSpace space, const TypicalBackground& background) {
  return best_box(boxes, expected_of_pale(space, background));
}

// Returns the first value below `end` for which a monotonic condition holds, or `end`.
template <class Condition>
static std::uint32_t first_value(std::uint32_t end, Condition holds) {
  std::uint32_t begin = 0;
  while (begin < end) {
    const std::uint32_t middle = (begin + end) / 2;
    if (holds(middle)) {
      end = middle;
    } else {
      begin = middle + 1;
    }
  }
  return end;
}

ValueRange before_correction(ValueRange corrected_range, std::uint8_t level, std::uint8_t black) {
  // Both conditions below are monotonic in the value, as first_value() requires.
  const auto reaches_low = [&](std::uint32_t value) {
    return corrected(static_cast<std::uint8_t>(value), level, black) >= corrected_range.low;
  };
  const auto passes_high = [&](std::uint32_t value) {
    const std::uint8_t seen = corrected(static_cast<std::uint8_t>(value), level, black);
    return (value == kFullScale ? kFullScale : seen) > corrected_range.high;
  };
  const std::uint32_t low = first_value(kFullScale, reaches_low), end = first_value(kFullScale + 1u, passes_high);
  if (end <= low || !reaches_low(low)) return {1, 0};
  return {static_cast<std::uint8_t>(low), static_cast<std::uint8_t>(end - 1)};
}

static ColorBoxes widened_by(std::uint8_t levels, const ColorBoxes& boxes) {
  ColorBoxes widened = boxes;
  for (ColorBox& box : widened) {
    for (std::size_t c = 0; c < 3; ++c) {
      box.low[c] = static_cast<std::uint8_t>(std::max(0, box.low[c] - levels));
      box.high[c] = static_cast<std::uint8_t>(std::min(255, box.high[c] + levels));
    }
  }
  return widened;
}

bool have_moved_within(std::uint8_t levels, const ColorBoxes& moved, const ColorBoxes& boxes) {
  if (moved.size() != boxes.size()) return false;
  const ColorBoxes widest = widened_by(levels, boxes);
  for (std::size_t i = 0; i < moved.size(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      if (moved[i].low[c] < widest[i].low[c] || moved[i].high[c] > widest[i].high[c]) return false;
    }
  }
  return true;
}

void BackgroundRanges::build(PixelFormat format, const ColorBoxes& boxes, std::uint8_t box_shift_limit,
                             const TypicalBackground& background) {
  const ColorBoxes widened = widened_by(box_shift_limit, boxes);
  format_ = format;
  const BackgroundBox dark = find_background_box(widened, color_space(format));
  const BackgroundBox usual = background ? find_background_box(widened, color_space(format), background) : dark;
  const std::array<std::uint8_t, 3>& low = usual.exists ? usual.low : dark.low;
  begin_at_zero_ = low == std::array<std::uint8_t, 3>{} && dark.low == low;
  exist_ = dark.exists;
  has_pale_ = exist_ && is_yuv(color_space(format));
  if (!exist_) return;
  dark_ = ranges_of(dark);
  usual_ = usual.exists ? ranges_of(usual) : dark_;
  if (!has_pale_) return;
  const BackgroundBox pale = find_pale_box(widened, color_space(format), background);
  has_pale_ = pale.exists;
  pale_ = ranges_of(pale);
}

BackgroundRanges::Ranges BackgroundRanges::ranges_of(const BackgroundBox& box) const {
  Ranges ranges{};
  for (std::size_t c = 0; c < 3; ++c) {
    const std::uint8_t black = black_value(color_space(format_), c);
    for (std::uint8_t level = 0; level < kLightLevels; ++level) {
      ranges[c][level] = before_correction({box.low[c], box.high[c]}, level, black);
    }
  }
  return ranges;
}

TileParameters BackgroundRanges::of(const std::array<std::uint8_t, 3>& level) const {
  const auto is_empty = [&](std::size_t c) { return usual_[c][level[c]].low > usual_[c][level[c]].high; };
  const Ranges& ranges = is_empty(0) || is_empty(1) || is_empty(2) ? dark_ : usual_;
  TileParameters tile;
  for (std::size_t c = 0; c < 3; ++c) tile.level[c] = level[c];
  set_background({ranges[0][level[0]], ranges[1][level[1]], ranges[2][level[2]]}, tile);
  return tile;
}

bool BackgroundRanges::find_pale(std::span<const TileParameters> tiles, TileParameters& pale) const {
  if (!has_pale_) return false;
  std::array<ValueRange, 3> all{{{0, 255}, {0, 255}, {0, 255}}};
  for (const TileParameters& tile : tiles) {
    for (std::size_t c = 0; c < 3; ++c) {
      const ValueRange range = pale_[c][tile.level[c]];
      all[c] = {std::max(all[c].low, range.low), std::min(all[c].high, range.high)};
    }
  }
  for (const ValueRange& range : all) {
    if (range.low > range.high) return false;
  }
  set_background(all, pale);
  return true;
}

void BackgroundRanges::set_background(const std::array<ValueRange, 3>& ranges, TileParameters& tile) const {
  const std::array<std::uint8_t, 3> at = background_bytes(format_);
  const auto set = [&](std::size_t byte, ValueRange range) {
    tile.background_low[byte] = range.low;
    tile.background_extent[byte] = static_cast<std::uint8_t>(range.high - range.low);
  };
  for (std::size_t c = 0; c < 3; ++c) set(at[c], ranges[c]);
  if (info_of(format_).planes > 1) set(1, ranges[0]);
  if (info_of(format_).packing == Packing::kPacked422) set(at[0] + 2u, ranges[0]);
}

}  // namespace touchline
