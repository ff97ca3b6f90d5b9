#pragma once

#include <array>
#include <cstdint>

#include "core/light/shading.h"
#include "core/types.h"

namespace touchline {

// 640 x 480 pixels have 40 x 30 cells; the smallest shadow that matters covers several of them.
constexpr std::size_t kMaxReferenceCells = 2000;
constexpr std::size_t kMaxReferenceRows = kMaxFrameHeight / (std::size_t{2} * kTileHeight) + 1;

/// Cells of whole tiles (see shading.h), at most kMaxReferenceCells for a picture of any size. A cell is one tile wide
/// and two tiles high (16 x 16 pixels), or a multiple of this size. Cells at the right and lower edge may be cut off.
struct ReferenceGrid {
  std::uint16_t columns = 0, rows = 0;
  std::uint16_t side_px = 0;

  /// Sizes may be from 1 to the capacity of a frame.
  static ReferenceGrid of(std::uint16_t width_px, std::uint16_t height_px);
  [[nodiscard]] std::size_t cells() const { return std::size_t{columns} * rows; }
  [[nodiscard]] std::uint16_t tile_rows() const { return static_cast<std::uint16_t>(side_px / kTileHeight); }
  [[nodiscard]] std::size_t cell_of_tile(std::uint16_t column, std::uint16_t row) const {
    return std::size_t{row} / tile_rows() * columns + column / (side_px / kTileWidth);
  }
};

/// Colors of the field's cells, R, G, B: sums of four pixels at fixed positions, so the unit is 1/4 pixel value. 0: the
/// cell is not usable, because it was covered, too dark or saturated.
struct CellColors {
  std::array<std::array<std::uint16_t, kMaxReferenceCells>, 3> sum{};
};

/// The field as it looked in the light in which the colors were learned. columns 0: there is no reference.
struct LightReference {
  std::uint16_t columns = 0, rows = 0;
  CellColors colors;
};

/// Reads four pixels of each cell in a row of cells. YUV is converted to RGB (ITU-R BT.601). `grid` must be the grid of
/// the frame's size.
void sample_cells(const Frame& frame, const ReferenceGrid& grid, std::size_t row, CellColors& out);

}  // namespace touchline
