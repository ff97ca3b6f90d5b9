#pragma once

#include <array>
#include <cstdint>

#include "core/light/light_reference.h"
#include "core/types.h"

namespace touchline {

/// Measures the change of light (exposure, lamps, tint, shadows) from the field itself, without any recognized robot:
/// compares a few pixels of each cell with a reference of the field in the light in which the colors were learned.
///
/// The logarithm of the ratio is a level per cell and channel. The change of light at a cell is the most frequent level
/// in a window around it. Cells that robots or people cover have other levels than the floor beside them, and do not
/// count unless they are the majority of the window; cells of another tint than most of the field do not count at all.
/// Where no level is frequent enough, the change is interpolated (Gortler et al. 1996, pull-push).
///
/// Every frame, an eighth of the rows is measured. If more of their cells disagree with the known change than usual,
/// the whole field is measured at once, so that a step of the light is known before the colors of the same frame are
/// classified.
/// A change smaller than 1.5 levels (3 %) counts as none. The work is bounded, and its result does not depend on
/// floating point. The object is large (fixed memory).
class FieldLight {
 public:
  /// Starts without a change. A reference without columns turns it off. kOutOfRange: an empty or too large picture.
  /// kInconsistent: the reference was made for another picture size. It is off then, too.
  Status configure(const LightReference& reference, PixelFormat format, std::uint16_t width_px,
                   std::uint16_t height_px);
  /// Forgets the change.
  void reset();
  [[nodiscard]] bool active() const { return grid_.columns > 0; }

  /// Measures. The frame must have the configured format and size and all planes. Returns true if at() has changed;
  /// changed() tells where.
  bool measure(const Frame& frame);
  [[nodiscard]] bool changed(std::uint16_t tile_row) const {
    return active() && row_changed_[tile_row / grid_.tile_rows()];
  }

  /// Change of light in a tile, in levels (32 per octave); positive: brighter than in the reference. 0 when off. In YUV
  /// it is the change of a gray surface's luma, for all channels.
  [[nodiscard]] float at(std::size_t channel, std::uint16_t tile_column, std::uint16_t tile_row) const;
  [[nodiscard]] std::array<float, 3> at(std::uint16_t tile_column, std::uint16_t tile_row) const;
  /// The same of R, G and B, also in YUV.
  [[nodiscard]] float rgb_at(std::size_t channel, std::uint16_t tile_column, std::uint16_t tile_row) const;
  /// Part of the reference's cells that show the floor in a plausible light, among those that the last frame was
  /// compared with: an eighth of the rows, or all. Robots and people cover cells; in the dark none is recognizable.
  /// Negative: not measured.
  [[nodiscard]] float recognized() const { return recognized_; }
  /// Mean over all cells and channels.
  [[nodiscard]] float mean() const { return mean_; }
  /// Mean over all cells of R, G and B, also in YUV.
  [[nodiscard]] const std::array<float, 3>& channel_means() const { return channel_means_; }

 private:
  // Fixed point: 1/8 level.
  using Steps = std::int16_t;
  using Plane = std::array<Steps, kMaxReferenceCells>;
  // A row is measured in every eighth frame.
  static constexpr std::size_t kRowStep = 8;
  // How well the measured cells of some rows agree with the known change.
  struct Agreement {
    std::int32_t cells = 0, fitting = 0;      // number; share of them that nearly agree
    std::array<std::int32_t, 3> deviation{};  // mean of those

    void approach(const Agreement& now) {
      fitting += (now.fitting - fitting) / 2;
      for (std::size_t c = 0; c < 3; ++c) deviation[c] += (now.deviation[c] - deviation[c]) / 2;
    }
  };
  // Weight, and the sums of weight * ratio of each channel.
  using Sums [[gnu::vector_size(16)]] = std::int32_t;
  class Window;

  void compare(const Frame& frame, std::size_t row);
  void find_tint();
  void find_brightness(std::size_t row);
  [[nodiscard]] Agreement agreement(std::size_t first_row) const;
  void find_recognized(std::size_t first_row, std::size_t step);
  static bool differs(const Agreement& now, const Agreement& usual);
  [[nodiscard]] bool find_change(std::size_t row);
  bool interpolate();

  ReferenceGrid grid_;
  ColorSpace space_ = ColorSpace::kRgb;
  // Of the reference: logarithm, usable channels as bits, weight of the cell.
  std::array<Plane, 3> reference_{};
  std::array<std::uint8_t, kMaxReferenceCells> usable_{}, weight_{};
  std::size_t base_channel_ = 1;  // the channel with the most usable cells
  // Of the present field. Rows that were not measured in this frame are older.
  CellColors now_;
  std::array<Plane, 3> ratio_{};
  std::array<std::uint8_t, kMaxReferenceCells> measured_{};  // channels as bits
  // Of the brightness of the base channel, which follows from all measured ones.
  std::array<std::uint8_t, kMaxReferenceCells> bin_{};
  std::array<Sums, kMaxReferenceCells> sums_{};
  std::array<Steps, 3> tint_{};   // of most cells, relative to the base channel
  std::array<Plane, 3> found_{};  // valid if known_
  std::array<bool, kMaxReferenceCells> known_{};
  std::array<Plane, 3> change_{};
  std::array<bool, kMaxReferenceRows> row_changed_{};
  // The cells and the coarser grids of interpolate(); each has at most about a quarter of the cells of the one before.
  struct GridCell {
    std::array<Steps, 3> value{};
    bool known = false;
  };
  std::array<GridCell, kMaxReferenceCells * 3 / 2> pyramid_{};
  float recognized_ = -1;
  float mean_ = 0;
  std::array<float, 3> channel_means_{};
  std::size_t next_ = 0;
  bool started_ = false;
  std::array<Agreement, kRowStep> usual_{};  // of the rows of each frame; valid if started_
};

}  // namespace touchline
