#pragma once

#include <array>
#include <cstdint>

#include "core/color/color_tables.h"
#include "core/color/row_classifier.h"
#include "core/light/shading.h"
#include "core/region/region_of_interest.h"
#include "core/types.h"

namespace touchline {

/// A copy of everything that decides the classes of a frame's pixels, for threads that examine single pixels while the
/// scanner works on the next frames. It applies the definition that all kernels implement (ColorTables). 0.7 MB: not
/// for the stack.
class PixelClassifier {
 public:
  /// Copies about 0.5 MB. Never allocates.
  void copy(const RowClassifier& classifier, const RegionOfInterest& region_of_interest);

  /// Whether the pixel is in the region of interest. Here and below, the pixel must be in the picture.
  [[nodiscard]] bool is_inside(std::uint16_t u, std::uint16_t v) const;
  /// Class of a pixel inside. `frame` has the format and size of the scanner's frames.
  [[nodiscard]] ColorId color_at(const Frame& frame, std::uint16_t u, std::uint16_t v) const {
    return tables_.color_of(tables_.mask(pixel_at(frame, u, v), levels_of_tile(u / kTileWidth, v / kTileHeight)));
  }

  /// Tiles of the light map; 0: there is none.
  [[nodiscard]] std::uint16_t tile_columns() const { return columns_; }
  [[nodiscard]] std::uint16_t tile_rows() const { return rows_; }
  /// Light level of each channel, by which values of this tile are corrected (gain_of_level); neutral without a light
  /// map.
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
