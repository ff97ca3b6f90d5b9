#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "core/color/color_tables.h"
#include "core/light/shading.h"
#include "core/types.h"

namespace touchline {

/// What most of the background shows, corrected by the light map, by channel; none: unknown.
using TypicalBackground = std::optional<std::array<std::uint8_t, 3>>;

/// A box of color space, bounds inclusive, that no color's box meets and that holds the typical background, or black
/// when that is unknown: a pixel in it is background at a glance. Of all such boxes the one that holds most of what
/// backgrounds look like: about the typical one, or any brightness, and in YUV little chroma, which is what white
/// balance makes of carpets, lines and robots' tops.
struct BackgroundBox {
  std::array<std::uint8_t, 3> low{}, high{};
  bool exists = false;  // false: what it must hold is in some box
};
BackgroundBox find_background_box(const ColorBoxes& boxes, ColorSpace space, const TypicalBackground& background = {});

/// The values that the light level moves into low..high, full scale being any value above as well (ColorTables). None:
/// low above high.
struct ValueRange {
  std::uint8_t low = 0, high = 0;
};
ValueRange before_correction(ValueRange corrected_range, std::uint8_t level, std::uint8_t black);

/// Light level and background range of a tile of Shading. If there is a BackgroundBox, a pixel is background when
/// value - background_low <= background_extent for each of its bytes, with differences modulo 256.
struct TileParameters {
  std::array<std::uint8_t, 4> level{};  // by channel
  // By byte: R G B -, B G R -, Y U Y V, U Y V Y; with chroma in planes of its own Y Y U V. Unused bytes have any value.
  std::array<std::uint8_t, 4> background_low{};
  std::array<std::uint8_t, 4> background_extent{255, 255, 255, 255};
};

/// Where in TileParameters a format's channels are: as in the first plane, or chroma of planes of its own in bytes 2
/// and 3. Packed formats with two luma samples repeat luma two bytes further, others with planes in byte 1.
constexpr std::array<std::uint8_t, 3> background_bytes(PixelFormat format) {
  std::array<std::uint8_t, 3> bytes{};
  for (std::size_t c = 0; c < 3; ++c) {
    const ChannelLayout& channel = info_of(format).channel[c];
    bytes[c] = channel.plane == 0 ? channel.offset : static_cast<std::uint8_t>(c + 1);
  }
  return bytes;
}

/// Background ranges of all channels at every light level, by which those of a tile are put together.
class BackgroundRanges {
 public:
  /// Errors: none. Boxes may be moved later by up to `box_shift_limit` levels. A typical background within reach of a
  /// box counts as unknown.
  void build(PixelFormat format, const ColorBoxes& boxes, std::uint8_t box_shift_limit,
             const TypicalBackground& background = {});
  [[nodiscard]] TileParameters of(const std::array<std::uint8_t, 3>& level) const;
  [[nodiscard]] bool exist() const { return exist_; }
  /// Whether they all begin at 0, as they do in R, G, B when the typical background is unknown or dark.
  [[nodiscard]] bool begin_at_zero() const { return begin_at_zero_; }

 private:
  // By channel and level.
  using Ranges = std::array<std::array<ValueRange, kLightLevels>, 3>;
  [[nodiscard]] Ranges ranges_of(const BackgroundBox& box) const;

  PixelFormat format_ = PixelFormat::kRgb24;
  bool exist_ = false, begin_at_zero_ = false;
  Ranges usual_{}, dark_{};  // dark_: where no value is in the usual ones; it holds the black value at all levels
};

}  // namespace touchline
