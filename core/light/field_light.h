#pragma once

#include <array>
#include <cstdint>

#include "core/light/light_reference.h"
#include "core/types.h"

namespace touchline {

/// Measures the change of light (exposure, lamps, tint, shadows) from the field itself, without any recognized robot.
/// Compares a few pixels of each cell with a reference picture of the field, taken in the light in which the colors
/// were learned.
///
/// The logarithm of the ratio is a level per cell and channel. The change of light at a cell is the mode of the levels
/// in a window around it. Cells that robots or people cover differ from the floor beside them, so they do not affect
/// the mode unless they fill most of the window. Cells of another tint than most of the field do not count at all.
/// Where no level is frequent enough, the change is interpolated (Gortler et al. 1996, pull-push).
///
/// Each frame measures an eighth of the rows. If their cells disagree with the known change more than usual, the whole
/// field is measured at once. A step of the light is therefore known before the frame's colors are classified. A change
/// below 1.5 levels (3 %) counts as none. The work is bounded, and the arithmetic is in integers. The object is large
/// (fixed memory).
class FieldLight {
 public:
  /// Starts without a change. A reference without columns turns the measurement off. kOutOfRange: an empty or too large
  /// picture. kInconsistent: the reference was made for another picture size. Either error also turns the measurement
  /// off.
  Status configure(const LightReference& reference, PixelFormat format, std::uint16_t width_px,
                   std::uint16_t height_px);
  /// Forgets the change.
  void reset();
  [[nodiscard]] bool active() const { return grid_.columns > 0; }

  /// Measures the light of a frame, which must have the configured format and size and all planes. Returns true if at()
  /// has changed; changed() tells where.
  bool measure(const Frame& frame);
  [[nodiscard]] bool changed(std::uint16_t tile_row) const {
    return active() && row_changed_[tile_row / grid_.tile_rows()];
  }

  /// Returns the change of light in a tile, in levels (32 per octave); positive: brighter than in the reference. 0 when
  /// off. In YUV, all channels have the change of a gray surface's luma.
  [[nodiscard]] float at(std::size_t channel, std::uint16_t tile_column, std::uint16_t tile_row) const;
  [[nodiscard]] std::array<float, 3> at(std::uint16_t tile_column, std::uint16_t tile_row) const;
  /// Returns the change of R, G or B, also in YUV.
  [[nodiscard]] float rgb_at(std::size_t channel, std::uint16_t tile_column, std::uint16_t tile_row) const;
  /// Share of the reference's cells that show the floor in a plausible light, among the cells of the last frame that
  /// were compared (an eighth of the rows, or all). Robots and people cover cells; in the dark no cell is recognizable.
  /// Negative: not measured.
  [[nodiscard]] float recognized() const { return recognized_; }
  /// Mean change over all cells and channels.
  [[nodiscard]] float mean() const { return mean_; }
  /// Returns the mean change of R, G and B over all cells, also in YUV.
  [[nodiscard]] const std::array<float, 3>& channel_means() const { return channel_means_; }

 private:
  // Fixed-point number in units of 1/8 level.
  using Steps = std::int16_t;
  using Plane = std::array<Steps, kMaxReferenceCells>;
  // A row is measured in every eighth frame.
  static constexpr std::size_t kRowStep = 8;
  // Agreement of the measured cells of some rows with the known change.
  struct Agreement {
    std::int32_t cells = 0, fitting = 0;      // number of cells; share of them that agrees or nearly agrees
    std::array<std::int32_t, 3> deviation{};  // mean deviation of the cells that agree

    void approach(const Agreement& now) {
      fitting += (now.fitting - fitting) / 2;
      for (std::size_t c = 0; c < 3; ++c) deviation[c] += (now.deviation[c] - deviation[c]) / 2;
    }
  };
  // Weight, and the weighted sum of each channel's ratio.
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
  // Data of the reference: logarithm of the values, usable channels as bits, weight of each cell.
  std::array<Plane, 3> reference_{};
  std::array<std::uint8_t, kMaxReferenceCells> usable_{}, weight_{};
  std::size_t base_channel_ = 1;  // channel with the most usable cells
  // Colors of the field at present. Rows that this frame did not measure are from earlier frames.
  CellColors now_;
  std::array<Plane, 3> ratio_{};
  std::array<std::uint8_t, kMaxReferenceCells> measured_{};  // channels as bits
  // For each cell: bin of the base channel's brightness, estimated from all measured channels, and weighted sums.
  std::array<std::uint8_t, kMaxReferenceCells> bin_{};
  std::array<Sums, kMaxReferenceCells> sums_{};
  std::array<Steps, 3> tint_{};   // median tint of the cells, relative to the base channel
  std::array<Plane, 3> found_{};  // valid if known_
  std::array<bool, kMaxReferenceCells> known_{};
  std::array<Plane, 3> change_{};
  std::array<bool, kMaxReferenceRows> row_changed_{};
  // The cells, followed by the coarser grids of interpolate(). Each grid has about a quarter of the previous grid's
  // cells.
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
  std::array<Agreement, kRowStep> usual_{};  // for each group of rows; valid if started_
};

}  // namespace touchline
