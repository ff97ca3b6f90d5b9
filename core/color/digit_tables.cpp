#include "core/color/digit_tables.h"

#include <bit>

namespace touchline {
namespace {

// Of one class, whose values are all from the first to the last: correction by light never reverses an order.
void add_class(const ColorTables::Table& table, std::size_t bit, ChannelDigits& digits) {
  const std::uint32_t mask = std::uint32_t{1} << bit;
  std::size_t first = 0, last = table.size() - 1;
  while (first < table.size() && (table[first] & mask) == 0) ++first;
  if (first == table.size()) return;  // no value is corrected into the box
  while ((table[last] & mask) == 0) --last;
  const std::size_t group = bit / kClassesOfGroup;
  const auto set = [bit](std::uint8_t& byte, bool is) {
    if (is) byte = static_cast<std::uint8_t>(byte | 1u << bit % kClassesOfGroup);
  };
  for (std::size_t digit = 0; digit < 16; ++digit) {
    set(digits.within[group][digit], first / 16 <= digit && digit <= last / 16);
    set(digits.above_first[group][digit], digit > first / 16);
    set(digits.from_first[group][digit], digit >= first % 16);
    set(digits.below_last[group][digit], digit < last / 16);
    set(digits.to_last[group][digit], digit <= last % 16);
  }
}

}  // namespace

void DigitTableSet::build(const ColorTables& tables, std::size_t boxes) {
  groups_ = (boxes + kClassesOfGroup - 1) / kClassesOfGroup;
  for (std::size_t channel = 0; channel < digits_.size(); ++channel) {
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

void DigitTableSet::rebuild(const ColorTables& tables, std::size_t boxes, std::size_t channel, std::uint8_t level) {
  digits_[channel][level] = {};
  for (std::size_t bit = 0; bit < boxes; ++bit) add_class(tables.table(channel, level), bit, digits_[channel][level]);
}

}  // namespace touchline
