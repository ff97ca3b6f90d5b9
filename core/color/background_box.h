#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "core/color/color_tables.h"
#include "core/light/shading.h"
#include "core/types.h"

namespace touchline {

/// Typical value of the background in each channel, corrected by the light map. Empty if it is unknown.
using TypicalBackground = std::optional<std::array<std::uint8_t, 3>>;

/// A box in color space, bounds inclusive, that overlaps no color box. A single cheap test shows that a pixel in this
/// box is background. The box contains the typical background, or black if the background is unknown. Of all such
/// boxes, it contains the largest share of expected background values. If the background is known, values near it are
/// expected; otherwise any brightness, and in YUV little chroma, because white balance gives little chroma to carpets,
/// lines and the tops of robots.
struct BackgroundBox {
  std::array<std::uint8_t, 3> low{}, high{};
  bool exists = false;  // false: the value that the box must contain lies in a color box
};
BackgroundBox find_background_box(const ColorBoxes& boxes, ColorSpace space, const TypicalBackground& background = {});

/// Finds a second background box for YUV: any brightness, and the chroma of the typical background (little chroma if it
/// is unknown). This box rejects lines and the surroundings of a field. Like the first background box, it contains the
/// typical background or black.
BackgroundBox find_pale_box(const ColorBoxes& boxes, ColorSpace space, const TypicalBackground& background = {});

/// Returns whether no box has moved by more than `levels` from the box with the same index in `boxes`.
bool have_moved_within(std::uint8_t levels, const ColorBoxes& moved, const ColorBoxes& boxes);

/// An interval of values, bounds inclusive. It is empty if low is above high.
struct ValueRange {
  std::uint8_t low = 0, high = 0;
};
/// Returns the values that correction by the light level moves into `corrected_range`. A saturated value (full scale)
/// stands for all larger values, too (ColorTables).
ValueRange before_correction(ValueRange corrected_range, std::uint8_t level, std::uint8_t black);

/// Light level and background range of a tile of Shading. If there is a BackgroundBox, a pixel is background when
/// value - background_low <= background_extent for each of its bytes, with differences modulo 256.
struct TileParameters {
  std::array<std::uint8_t, 4> level{};  // by channel
  // Order of the bytes: R G B -, B G R -, Y U Y V, U Y V Y; with chroma in separate planes Y Y U V. Unused bytes have
  // any value.
  std::array<std::uint8_t, 4> background_low{};
  std::array<std::uint8_t, 4> background_extent{255, 255, 255, 255};

  bool operator==(const TileParameters&) const = default;
};

/// For each channel, the index of its byte in TileParameters::background_low: its offset in the first plane, or 2 or 3
/// for chroma in other planes. A second luma sample repeats the luma byte: two bytes later in packed formats, in byte 1
/// in planar formats.
constexpr std::array<std::uint8_t, 3> background_bytes(PixelFormat format) {
  std::array<std::uint8_t, 3> bytes{};
  for (std::size_t c = 0; c < 3; ++c) {
    const ChannelLayout& channel = info_of(format).channel[c];
    bytes[c] = channel.plane == 0 ? channel.offset : static_cast<std::uint8_t>(c + 1);
  }
  return bytes;
}

/// The background box of each light level, in pixel values before correction.
class BackgroundRanges {
 public:
  /// Finds the background box and, in YUV, the pale box for color boxes that may later move by up to `box_shift_limit`
  /// levels. A typical background that a moved color box can contain counts as unknown.
  void build(PixelFormat format, const ColorBoxes& boxes, std::uint8_t box_shift_limit,
             const TypicalBackground& background = {});
  [[nodiscard]] TileParameters of(const std::array<std::uint8_t, 3>& level) const;
  /// Writes to `pale`, as its background, the values that the pale box contains at every one of these light levels; the
  /// levels of `pale` are undefined. Returns false if there are no such values, or if the format is RGB.
  [[nodiscard]] bool find_pale(std::span<const TileParameters> tiles, TileParameters& pale) const;
  [[nodiscard]] bool exist() const { return exist_; }
  /// Returns whether all ranges begin at 0. In RGB, all ranges begin at 0 if the typical background is unknown or dark.
  [[nodiscard]] bool begin_at_zero() const { return begin_at_zero_; }

 private:
  // Indices: channel, level.
  using Ranges = std::array<std::array<ValueRange, kLightLevels>, 3>;
  [[nodiscard]] Ranges ranges_of(const BackgroundBox& box) const;
  void set_background(const std::array<ValueRange, 3>& ranges, TileParameters& tile) const;

  PixelFormat format_ = PixelFormat::kRgb24;
  bool exist_ = false, begin_at_zero_ = false, has_pale_ = false;
  Ranges usual_{}, dark_{};  // `dark_` is for levels at which `usual_` is empty; it contains black at all levels.
  Ranges pale_{};
};

}  // namespace touchline
