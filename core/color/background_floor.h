#pragma once

#include <array>
#include <cstdint>

#include "core/color/color_tables.h"
#include "core/light/shading.h"
#include "core/types.h"

namespace touchline {

/// One value a channel, 0 to 256: every box's low bound reaches the floor in at least one channel, so that a pixel
/// which is below the floor in all three lies in no box. Of all such floors the one that rejects the largest part of
/// the color space.
using ChannelFloors = std::array<std::uint16_t, 3>;
ChannelFloors floors_of(const ColorBoxes& boxes);

/// The smallest value that the light level lifts to the floor, full scale being any value above as well (ColorTables);
/// 256 for a floor of 256, which nothing reaches. `unlit` as in corrected().
std::uint16_t floor_before_correction(std::uint16_t floor, std::uint8_t level, std::uint8_t unlit);

// Eight pixels are tested at once, 24 bytes of RGB.
constexpr std::size_t kBlockPixels = 8, kMaxBlockWords = 3;

/// Tests eight pixels at once, eight bytes a machine word, against the floors. Exact in one direction: what it calls
/// background is background by the tables.
class BackgroundFloor {
 public:
  BackgroundFloor() = default;
  BackgroundFloor(PixelFormat format, const ChannelFloors& floors);

  /// Words of a block: RGB24 and BGR24 three, YUYV and UYVY two, NV12 two (luma, chroma).
  [[nodiscard]] static constexpr std::size_t words(PixelFormat format) {
    return color_space(format) == ColorSpace::kRgb ? 3 : 2;
  }

  /// False when nothing is ever rejected.
  [[nodiscard]] bool can_reject() const { return can_reject_; }
  /// For 16 pixels of RGB24 or BGR24, byte by byte: the largest value below the floor. Only when can_reject().
  [[nodiscard]] const std::array<std::uint8_t, 48>& highest_below() const { return highest_below_; }

  /// True when all bytes of the block are below the floors of their channels.
  template <std::size_t kWords>
  [[nodiscard]] bool rejects(const std::array<std::uint64_t, kWords>& block) const {
    std::uint64_t reached = 0;
    for (std::size_t i = 0; i < kWords; ++i) {
      // A byte's high bit becomes (value & 127) + addend >= 128; no byte carries into the next, 127 + 128 = 255.
      const std::uint64_t sum = (block[i] & ~kHighBits) + addend_[i];
      // Floors up to 128 are reached by the sum or the value's own high bit, higher ones need both: a majority vote.
      reached |= (sum & block[i]) | (either_[i] & (sum | block[i]));
    }
    return (reached & kHighBits) == 0;
  }

 private:
  static constexpr std::uint64_t kHighBits = 0x8080808080808080u;
  std::array<std::uint64_t, kMaxBlockWords> addend_{}, either_{};
  std::array<std::uint8_t, 48> highest_below_{};
  bool can_reject_ = false;
};

}  // namespace touchline
