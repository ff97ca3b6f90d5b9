#pragma once

#include <cstdint>
#include <vector>

namespace touchline::calibrate {

/// A value a pixel or a cell, in raster order; NaN: not known.
using Plane = std::vector<double>;

double median(std::vector<double>& values);

/// The coarse grid that a light map has: at most kMaxColumns x kMaxRows cells of at least kLeastCellSide_px.
class LightGrid {
 public:
  LightGrid(std::size_t width_px, std::size_t height_px);

  [[nodiscard]] std::size_t columns() const { return columns_; }
  [[nodiscard]] std::size_t rows() const { return rows_; }
  [[nodiscard]] std::size_t cells() const { return columns_ * rows_; }
  /// First pixel of a column or row of cells; of columns() and rows() the picture's end.
  [[nodiscard]] std::size_t left_px(std::size_t column) const { return column * width_px_ / columns_; }
  [[nodiscard]] std::size_t top_px(std::size_t row) const { return row * height_px_ / rows_; }

  /// Median of every cell's pixels that count; NaN where fewer than this share of its pixels do, or none.
  [[nodiscard]] Plane reduce(const Plane& pixels, const std::vector<std::uint8_t>& counts, double least_share) const;
  /// A cell without a value takes the nearest one's.
  void fill(Plane& plane) const;
  /// The paper's "slight Gaussian blurring", sigma one cell, mirrored at the border.
  [[nodiscard]] Plane smooth(const Plane& plane) const;
  /// Mean of the known cells around each cell, Gaussian weights of this sigma (in cells), without the cell itself; NaN
  /// where none is within three sigma (normalized convolution, Knutsson and Westin 1993).
  [[nodiscard]] Plane around(const Plane& plane, double sigma) const;

 private:
  std::size_t width_px_, height_px_, columns_, rows_;
};

}  // namespace touchline::calibrate
