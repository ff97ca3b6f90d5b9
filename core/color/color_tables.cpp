#include "core/color/color_tables.h"

namespace touchline {
namespace {

bool overlap(const ColorBox& a, const ColorBox& b) {
  for (std::size_t channel = 0; channel < 3; ++channel) {
    if (a.low[channel] > b.high[channel] || b.low[channel] > a.high[channel]) return false;
  }
  return true;
}

ColorTables::Table masks_of_values(const ColorBoxes& boxes, std::size_t channel) {
  ColorTables::Table masks{};
  for (std::size_t bit = 0; bit < boxes.size(); ++bit) {
    for (std::size_t value = boxes[bit].low[channel]; value <= boxes[bit].high[channel]; ++value) {
      masks[value] |= std::uint32_t{1} << bit;
    }
  }
  return masks;
}

}  // namespace

Status check(const ColorBoxes& boxes) {
  for (const ColorBox& box : boxes) {
    if (box.color == kBackground || box.color > kMaxColors) return ErrorCode::kOutOfRange;
    for (std::size_t channel = 0; channel < 3; ++channel) {
      if (box.low[channel] > box.high[channel]) return ErrorCode::kOutOfRange;
    }
  }
  return {};
}

bool overlapping_boxes(const ColorBoxes& boxes, std::size_t& first, std::size_t& second) {
  for (std::size_t a = 0; a < boxes.size(); ++a) {
    for (std::size_t b = a + 1; b < boxes.size(); ++b) {
      if (boxes[a].color == boxes[b].color || !overlap(boxes[a], boxes[b])) continue;
      first = a;
      second = b;
      return true;
    }
  }
  return false;
}

Status ColorTables::build(const ColorBoxes& boxes, ColorSpace space) {
  if (Status s = check(boxes); !s.ok()) return s;
  space_ = space;
  for (std::size_t bit = 0; bit < boxes.size(); ++bit) color_of_bit_[bit] = boxes[bit].color;
  for (std::size_t channel = 0; channel < 3; ++channel) {
    const Table masks = masks_of_values(boxes, channel);
    for (std::uint8_t level = 0; level < kLightLevels; ++level) fill(masks, channel, level);
  }
  return {};
}

void ColorTables::rebuild(const ColorBoxes& boxes, std::size_t channel, std::uint8_t level) {
  fill(masks_of_values(boxes, channel), channel, level);
}

void ColorTables::fill(const Table& masks, std::size_t channel, std::uint8_t level) {
  const std::array<std::uint8_t, 256> seen = corrected_values(level, black_value(space_, channel));
  Table& table = table_[channel][level];
  for (std::size_t value = 0; value < table.size(); ++value) table[value] = masks[seen[value]];
  for (std::size_t value = seen[kFullScale]; value < masks.size(); ++value) table[kFullScale] |= masks[value];
}

}  // namespace touchline
