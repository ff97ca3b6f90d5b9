#pragma once

#include <array>
#include <cstdint>

#include "core/color/color_tables.h"
#include "core/light/shading.h"
#include "core/types.h"

namespace touchline {

// A byte shuffle looks up one byte per pixel for many pixels at once, so classes are processed in groups of eight bits.
constexpr std::size_t kClassesOfGroup = 8, kClassGroups = kMaxColorBoxes / kClassesOfGroup;

/// Class bits of one group by nibble, and a lookup for each group.
using NibbleLookup = std::array<std::uint8_t, 16>;
using GroupLookups = std::array<NibbleLookup, kClassGroups>;
static_assert(kClassGroups % 2 == 0);

/// Tables for the classes of a channel's value by its two nibbles: value = 16 * high + low. The values of a class are
/// an interval. The class contains a value if its bit is set in
///   within[high] & (above_first[high] | from_first[low]) & (below_last[high] | to_last[low]).
struct alignas(32) ChannelNibbles {
  GroupLookups within{};       // the value's high nibble is between the high nibbles of the interval's ends
  GroupLookups above_first{};  // the value's high nibble is above that of the first value
  GroupLookups from_first{};   // the value's low nibble is not below that of the first value
  GroupLookups below_last{};   // the value's high nibble is below that of the last value
  GroupLookups to_last{};      // the value's low nibble is not above that of the last value
};

/// Tables for the color of the lowest of eight class bits, by the two nibbles of these bits: it is the entry in `low`,
/// or the entry in `high` if the entry in `low` is background.
struct alignas(32) ColorNibbles {
  GroupLookups low{}, high{};
};

/// The classes of ColorTables as tables of 16 bytes, for kernels that look up many pixels at a time with a byte
/// shuffle.
class NibbleTables {
 public:
  /// Builds the classes of the first `boxes` bits of `tables`, at every light level.
  void build(const ColorTables& tables, std::size_t boxes);
  /// Rebuilds one channel and level after ColorTables::rebuild().
  void rebuild(const ColorTables& tables, std::size_t boxes, std::size_t channel, std::uint8_t level);

  [[nodiscard]] const ChannelNibbles& channel(std::size_t channel, std::uint8_t level) const {
    return nibbles_[channel][level];
  }
  [[nodiscard]] const ColorNibbles& colors() const { return colors_; }
  /// Number of groups that contain a class.
  [[nodiscard]] std::size_t groups() const { return groups_; }

 private:
  std::array<std::array<ChannelNibbles, kLightLevels>, 3> nibbles_{};
  ColorNibbles colors_{};
  std::size_t groups_ = 0;
};

}  // namespace touchline
