#include "core/color/nibble_tables.h"

#include <bit>

namespace touchline {
namespace {

// Adds a class that contains the values from `first` to `last`.
void add_class(std::size_t bit, std::size_t first, std::size_t last, ChannelNibbles& nibbles) {
  const std::size_t group = bit / kClassesOfGroup;
  const auto set = [bit](std::uint8_t& byte, bool is) {
    if (is) byte = static_cast<std::uint8_t>(byte | 1u << bit % kClassesOfGroup);
  };
  for (std::size_t nibble = 0; nibble < 16; ++nibble) {
    set(nibbles.within[group][nibble], first / 16 <= nibble && nibble <= last / 16);
    set(nibbles.above_first[group][nibble], nibble > first / 16);
    set(nibbles.from_first[group][nibble], nibble >= first % 16);
    set(nibbles.below_last[group][nibble], nibble < last / 16);
    set(nibbles.to_last[group][nibble], nibble <= last % 16);
  }
}

}  // namespace

void NibbleTables::build(const ColorTables& tables, std::size_t boxes) {
  groups_ = (boxes + kClassesOfGroup - 1) / kClassesOfGroup;
  for (std::size_t channel = 0; channel < nibbles_.size(); ++channel) {
    for (std::uint8_t level = 0; level < kLightLevels; ++level) rebuild(tables, boxes, channel, level);
  }
  for (std::size_t group = 0; group < groups_; ++group) {
    for (std::uint32_t bits = 1; bits < 16; ++bits) {
      const std::uint32_t low = bits << group * kClassesOfGroup;
      colors_.low[group][bits] = tables.color_of(low);
      colors_.high[group][bits] = tables.color_of(low << 4);
    }
  }
}

void NibbleTables::rebuild(const ColorTables& tables, std::size_t boxes, std::size_t channel, std::uint8_t level) {
  const ColorTables::Table& table = tables.table(channel, level);
  ChannelNibbles& nibbles = nibbles_[channel][level];
  nibbles = {};
  // The values of a class have no gaps, because light correction is monotonic. A class is empty if no value is
  // corrected into it.
  std::array<std::size_t, kMaxColorBoxes> first{};
  std::uint32_t open = 0;
  for (std::size_t value = 0; value <= table.size(); ++value) {
    const std::uint32_t classes = value < table.size() ? table[value] : 0;
    for (std::uint32_t changed = classes ^ open; changed != 0; changed &= changed - 1) {
      const auto bit = static_cast<std::size_t>(std::countr_zero(changed));
      if ((classes >> bit & 1u) != 0) {
        first[bit] = value;
      } else if (bit < boxes) {
        add_class(bit, first[bit], value - 1, nibbles);
      }
    }
    open = classes;
  }
}

}  // namespace touchline
