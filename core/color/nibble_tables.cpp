#include "core/color/nibble_tables.h"

#include <bit>

namespace touchline {
namespace {

// Adds one class. Its values are all those from the first to the last, because light correction never decreases when
// the value grows.
void add_class(const ColorTables::Table& table, std::size_t bit, ChannelNibbles& nibbles) {
  const std::uint32_t mask = std::uint32_t{1} << bit;
  std::size_t first = 0, last = table.size() - 1;
  while (first < table.size() && (table[first] & mask) == 0) ++first;
  if (first == table.size()) return;  // no value is corrected into the box
  while ((table[last] & mask) == 0) --last;
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
  nibbles_[channel][level] = {};
  for (std::size_t bit = 0; bit < boxes; ++bit) add_class(tables.table(channel, level), bit, nibbles_[channel][level]);
}

}  // namespace touchline
