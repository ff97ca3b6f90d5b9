#pragma once

#include <array>
#include <bit>
#include <cstdint>

#include "core/light/shading.h"
#include "core/types.h"

namespace touchline {

/// A box of one color class: low <= value <= high in each channel (R, G, B or Y, U, V).
struct ColorBox {
  ColorId color = kBackground;
  std::array<std::uint8_t, 3> low{}, high{};
};
/// A color is the union of its boxes. Box i is bit i of the tables; where boxes meet, the lowest bit wins.
using ColorBoxes = FixedVector<ColorBox, kMaxColorBoxes>;

/// kOutOfRange: low above high in some channel, or color 0 or above kMaxColors.
Status check(const ColorBoxes& boxes);

/// Two boxes of different colors that have a common point, by their bits; false when there are none.
bool overlapping_boxes(const ColorBoxes& boxes, std::size_t& first, std::size_t& second);

/// Klancar section 3.2: three 256-entry tables of 32-bit masks, ANDed. The definition of every kernel.
/// There is one set of tables a light level, which holds the masks of the corrected values: shading correction costs
/// another pointer and no arithmetic. A full scale value says only that there was so much light or more: under a lamp,
/// where correction makes values smaller, it has the classes of all values from its own corrected one up.
class ColorTables {
 public:
  using Table = std::array<std::uint32_t, 256>;
  /// Indexed by the lowest bit of a mask; the last entry, of the mask 0, is the background.
  using ColorOfBit = std::array<ColorId, kMaxColorBoxes + 1>;

  /// Errors of check(); then nothing is changed. `space` says about which value light scales a channel.
  Status build(const ColorBoxes& boxes, ColorSpace space);

  /// The entries of one channel and light level anew, for boxes that were moved in this channel; their colors and their
  /// number are those of build(). A color is a product of three intervals: while only some of its entries are new,
  /// tables still say a box.
  void rebuild(const ColorBoxes& boxes, std::size_t channel, std::uint8_t level);

  /// The classes of a pixel as bits; level of each channel as in Shading.
  [[nodiscard]] std::uint32_t mask(const std::array<std::uint8_t, 3>& value,
                                   const std::array<std::uint8_t, 3>& level) const {
    return table_[0][level[0]][value[0]] & table_[1][level[1]][value[1]] & table_[2][level[2]][value[2]];
  }
  [[nodiscard]] ColorId color_of(std::uint32_t mask) const {
    return color_of_bit_[static_cast<std::size_t>(std::countr_zero(mask))];
  }
  [[nodiscard]] const Table& table(std::size_t channel, std::uint8_t level) const { return table_[channel][level]; }
  [[nodiscard]] const ColorOfBit& color_of_bit() const { return color_of_bit_; }

 private:
  void fill(const Table& masks, std::size_t channel, std::uint8_t level);

  std::array<std::array<Table, kLightLevels>, 3> table_{};
  ColorSpace space_ = ColorSpace::kRgb;
  ColorOfBit color_of_bit_{};  // of bits that no box has: never asked for
};

}  // namespace touchline
