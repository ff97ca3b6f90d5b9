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
/// A color is the union of its boxes. Box i is bit i of the tables; where boxes overlap, the lowest bit wins.
using ColorBoxes = FixedVector<ColorBox, kMaxColorBoxes>;

/// kOutOfRange: low above high in some channel, or color 0 or above kMaxColors.
Status check(const ColorBoxes& boxes);

/// Finds two boxes of different colors that overlap, as indices of `boxes`. Returns false if there are none.
bool overlapping_boxes(const ColorBoxes& boxes, std::size_t& first, std::size_t& second);

/// Three tables of 256 masks with 32 bits each. A pixel's classes are the AND of its three entries (Klancar, section
/// 3.2). Every kernel implements this definition.
///
/// Each light level has its own tables, with the masks of the corrected values. Shading correction therefore costs
/// another pointer, but no arithmetic. A saturated value (full scale) is only a lower bound of the light. Where the
/// correction reduces values, it therefore has the classes of all values from its corrected value upwards.
class ColorTables {
 public:
  using Table = std::array<std::uint32_t, 256>;
  /// Index: the lowest bit of a mask. The last entry stands for the mask 0, the background.
  using ColorOfBit = std::array<ColorId, kMaxColorBoxes + 1>;

  /// Builds all tables. `space` determines the value of black; light scales a channel's distance from black. Errors: as
  /// check(); the tables are unchanged then.
  Status build(const ColorBoxes& boxes, ColorSpace space);

  /// Rebuilds the table of one channel and light level for boxes that were moved in this channel. Number and colors of
  /// the boxes must be as in build(). Partly rebuilt tables still describe boxes, because a class is a product of three
  /// intervals.
  void rebuild(const ColorBoxes& boxes, std::size_t channel, std::uint8_t level);

  /// Returns the classes of a pixel as bits. `level`: light level of each channel, as in Shading.
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
  ColorOfBit color_of_bit_{};  // entries of bits without a box are never used
};

}  // namespace touchline
