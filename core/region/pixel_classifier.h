#pragma once

#include <array>
#include <cstdint>

#include "core/color/color_tables.h"
#include "core/color/row_classifier.h"
#include "core/light/shading.h"
#include "core/region/region_of_interest.h"
#include "core/types.h"

namespace touchline {

/// A copy of all data that determine the classes of a frame's pixels, for threads that examine single pixels while the
/// scanner works on the next frames. It applies the definition that all kernels implement (ColorTables). It takes 0.7
/// MB, so it does not belong on the stack.
class PixelClassifier {
 public:
  /// Copies about 0.5 MB. Never allocates.
  void copy(const RowClassifier& classifier, const RegionOfInterest& region_of_interest);

  /// Returns whether the pixel is in the region of interest. Here and below, the pixel must lie in the picture.
  [[nodiscard]] bool is_inside(std::uint16_t u, std::uint16_t v) const;
  /// Returns the class of a pixel in the region of interest. `frame` has the format and size of the scanner's frames.
  [[nodiscard]] ColorId color_at(const Frame& frame, std::uint16_t u, std::uint16_t v) const {
    return tables_.color_of(tables_.mask(pixel_at(frame, u, v), levels_of_tile(u / kTileWidth, v / kTileHeight)));
  }

  /// Columns and rows of the light map's tiles; 0 without a light map.
  [[nodiscard]] std::uint16_t tile_columns() const { return columns_; }
  [[nodiscard]] std::uint16_t tile_rows() const { return rows_; }
  /// Returns the light level of each channel by which values of this tile are corrected (gain_of_level); neutral
  /// without a light map.
  [[nodiscard]] std::array<std::uint8_t, 3> levels_of_tile(std::size_t column, std::size_t row) const {
    return columns_ == 0 ? level_[0] : level_[row * columns_ + column];
  }

 private:
  ColorTables tables_;
  RegionOfInterest region_of_interest_;
  std::uint16_t columns_ = 0, rows_ = 0;
  std::array<std::array<std::uint8_t, 3>, kMaxTiles> level_{};
};

}  // namespace touchline
