#pragma once

#include <array>
#include <cstdint>

#include "core/color/color_tables.h"
#include "core/light/shading.h"
#include "core/types.h"

namespace touchline {

// A byte of class bits: a byte shuffle looks up the classes of many pixels, eight classes at a time.
constexpr std::size_t kClassesOfGroup = 8, kClassGroups = kMaxColorBoxes / kClassesOfGroup;

/// 16 bytes that a nibble looks up, a group of classes each; those of two neighbors fill 32 bytes.
using NibbleLookup = std::array<std::uint8_t, 16>;
using GroupLookups = std::array<NibbleLookup, kClassGroups>;
static_assert(kClassGroups % 2 == 0);

/// The classes of a channel's value by its two nibbles, value = 16 * high + low. A class whose values are an
/// interval contains a value when its bit is in
///   within[high] & (above_first[high] | from_first[low]) & (below_last[high] | to_last[low]).
struct alignas(32) ChannelNibbles {
  GroupLookups within{};       // high nibble between those of the interval's ends
  GroupLookups above_first{};  // high nibble above that of the first value
  GroupLookups from_first{};   // low nibble not below that of the first value
  GroupLookups below_last{};   // high nibble below that of the last value
  GroupLookups to_last{};      // low nibble not above that of the last value
};

/// The color of the lowest of eight class bits, by their two nibbles: of low's entry unless that is
/// background, else of high's.
struct alignas(32) ColorNibbles {
  GroupLookups low{}, high{};
};

/// ColorTables for kernels that cannot look up 256 entries but many pixels at once. Says the same of every value.
class NibbleTables {
 public:
  /// The classes of the tables' first `boxes` bits, at every light level.
  void build(const ColorTables& tables, std::size_t boxes);
  /// Of one channel and level anew, after the same of the tables.
  void rebuild(const ColorTables& tables, std::size_t boxes, std::size_t channel, std::uint8_t level);

  [[nodiscard]] const ChannelNibbles& channel(std::size_t channel, std::uint8_t level) const {
    return nibbles_[channel][level];
  }
  [[nodiscard]] const ColorNibbles& colors() const { return colors_; }
  /// Groups that have a class.
  [[nodiscard]] std::size_t groups() const { return groups_; }

 private:
  std::array<std::array<ChannelNibbles, kLightLevels>, 3> nibbles_{};
  ColorNibbles colors_{};
  std::size_t groups_ = 0;
};

}  // namespace touchline
