#include "core/color/quiet_box.h"

#include <algorithm>

namespace touchline {
namespace {

// How much a value of the channel is expected of a background: any R, G, B and luma alike, chroma the nearer to none.
std::uint32_t weight(ColorSpace space, std::size_t channel, std::uint32_t value) {
  constexpr int kMostChroma = 64;
  if (space == ColorSpace::kRgb || channel == 0) return 1;
  const int chroma = static_cast<int>(value) - 128;
  return static_cast<std::uint32_t>(std::max(1, kMostChroma - std::max(chroma, -chroma)));
}
std::uint32_t weight(ColorSpace space, std::size_t channel, ValueRange range) {
  std::uint32_t sum = 0;
  for (std::uint32_t value = range.low; value <= range.high; ++value) sum += weight(space, channel, value);
  return sum;
}

struct Candidate {
  ValueRange range;
  std::uint64_t weight = 0;
};
using Bounds = FixedVector<std::uint8_t, kMaxColorBoxes + 1>;

bool meet(const ColorBox& box, std::size_t channel, ValueRange range) {
  return box.low[channel] <= range.high && box.high[channel] >= range.low;
}

// The widest range about `unlit` that meets none of the boxes; weight 0 when there is none.
Candidate widest(const ColorBoxes& boxes, ColorSpace space, std::size_t channel) {
  const std::uint8_t unlit = unlit_value(space, channel);
  ValueRange range = {0, 255};
  for (const ColorBox& box : boxes) {
    if (box.low[channel] > unlit) {
      range.high = std::min<std::uint8_t>(range.high, static_cast<std::uint8_t>(box.low[channel] - 1));
    } else if (box.high[channel] < unlit) {
      range.low = std::max<std::uint8_t>(range.low, static_cast<std::uint8_t>(box.high[channel] + 1));
    } else {
      return {};
    }
  }
  return {range, weight(space, channel, range)};
}

// The bounds that a best range of the channel can have: next to a box, or none.
void find_bounds(const ColorBoxes& boxes, ColorSpace space, std::size_t channel, Bounds& low, Bounds& high) {
  const std::uint8_t unlit = unlit_value(space, channel);
  low.push_back(0);
  high.push_back(255);
  for (const ColorBox& box : boxes) {
    if (box.low[channel] > unlit) high.push_back(static_cast<std::uint8_t>(box.low[channel] - 1));
    if (box.high[channel] < unlit) low.push_back(static_cast<std::uint8_t>(box.high[channel] + 1));
  }
  const auto make_unique = [](Bounds& bounds) {
    std::sort(bounds.begin(), bounds.end());
    bounds.resize(static_cast<std::size_t>(std::unique(bounds.begin(), bounds.end()) - bounds.begin()));
  };
  make_unique(low);
  make_unique(high);
}

// Calls `use` with every range that the channel may have, and the boxes that meet it.
template <class Use>
void for_each_range(const ColorBoxes& boxes, ColorSpace space, std::size_t channel, Use use) {
  Bounds lows, highs;
  find_bounds(boxes, space, channel, lows, highs);
  for (const std::uint8_t low : lows) {
    for (const std::uint8_t high : highs) {
      const ValueRange range = {low, high};
      ColorBoxes met;
      for (const ColorBox& box : boxes) {
        if (meet(box, channel, range)) met.push_back(box);
      }
      use(Candidate{range, weight(space, channel, range)}, met);
    }
  }
}

}  // namespace

QuietBox quiet_box_of(const ColorBoxes& boxes, ColorSpace space) {
  QuietBox best;
  std::uint64_t most = 0;
  for_each_range(boxes, space, 0, [&](const Candidate& first, const ColorBoxes& met_first) {
    for_each_range(met_first, space, 1, [&](const Candidate& second, const ColorBoxes& met_second) {
      const Candidate third = widest(met_second, space, 2);  // follows from the other two
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

ValueRange before_correction(ValueRange corrected_range, std::uint8_t level, std::uint8_t unlit) {
  const auto value_of = [&](std::uint8_t value) { return corrected(value, level, unlit); };
  ValueRange range = {unlit, unlit};
  while (range.low > 0 && value_of(static_cast<std::uint8_t>(range.low - 1)) >= corrected_range.low) --range.low;
  while (range.high < kFullScale - 1 && value_of(static_cast<std::uint8_t>(range.high + 1)) <= corrected_range.high) {
    ++range.high;
  }
  if (range.high == kFullScale - 1 && corrected_range.high == kFullScale) range.high = kFullScale;
  return range;
}

void QuietRanges::build(PixelFormat format, const ColorBoxes& boxes, std::uint8_t box_room) {
  const ColorSpace space = color_space(format);
  ColorBoxes widened = boxes;
  for (ColorBox& box : widened) {
    for (std::size_t c = 0; c < 3; ++c) {
      box.low[c] = static_cast<std::uint8_t>(std::max(0, box.low[c] - box_room));
      box.high[c] = static_cast<std::uint8_t>(std::min(255, box.high[c] + box_room));
    }
  }
  const QuietBox box = quiet_box_of(widened, space);
  format_ = format;
  exist_ = box.exists;
  if (!exist_) return;
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::uint8_t level = 0; level < kLightLevels; ++level) {
      range_[c][level] = before_correction({box.low[c], box.high[c]}, level, unlit_value(space, c));
    }
  }
}

TileLight QuietRanges::of(const std::array<std::uint8_t, 3>& level) const {
  TileLight tile;
  const std::array<std::uint8_t, 3> at = quiet_bytes(format_);
  const auto set = [&](std::size_t byte, ValueRange range) {
    tile.quiet_low[byte] = range.low;
    tile.quiet_reach[byte] = static_cast<std::uint8_t>(range.high - range.low);
  };
  for (std::size_t c = 0; c < 3; ++c) {
    tile.level[c] = level[c];
    set(at[c], range_[c][level[c]]);
  }
  if (format_ == PixelFormat::kNv12) set(1, range_[0][level[0]]);
  if (format_ == PixelFormat::kYuyv || format_ == PixelFormat::kUyvy) set(at[0] + 2u, range_[0][level[0]]);
  return tile;
}

}  // namespace touchline
