#pragma once

#include <cstdint>
#include <vector>

namespace touchline::calibrate {

/// One value per pixel or per cell in raster order; NaN: unknown.
using Plane = std::vector<double>;

/// 8-bit values: from kSaturated on, the sensor may be saturated; below kDark, one step is a change of more than 10 %.
inline constexpr double kSaturated = 250.0, kDark = 10.0;

/// The coarse grid of a light map: at most kMaxColumns x kMaxRows cells, each at least kMinCellSide_px wide and high.
class LightGrid {
 public:
  LightGrid(std::size_t width_px, std::size_t height_px);

  [[nodiscard]] std::size_t columns() const { return columns_; }
  [[nodiscard]] std::size_t rows() const { return rows_; }
  [[nodiscard]] std::size_t cells() const { return columns_ * rows_; }
  /// Return the first pixel of a column or row of cells. For columns() and rows(): the end of the picture.
  [[nodiscard]] std::size_t left_px(std::size_t column) const { return column * width_px_ / columns_; }
  [[nodiscard]] std::size_t top_px(std::size_t row) const { return row * height_px_ / rows_; }

  /// Returns the median of each cell's pixels with counts != 0; NaN if there are none or fewer than `least_share` of
  /// the cell's pixels.
  [[nodiscard]] Plane reduce(const Plane& pixels, const std::vector<std::uint8_t>& counts, double least_share) const;
  /// Gives each unknown cell the value of the nearest known one.
  void fill(Plane& plane) const;
  /// Applies Klancar's "slight Gaussian blurring": sigma of one cell, mirrored at the edge of the grid.
  [[nodiscard]] Plane smooth(const Plane& plane) const;
  /// Returns the Gaussian-weighted mean of the known cells around each cell, without the cell itself; `sigma` in cells.
  /// NaN if there is no known cell within three sigma (normalized convolution, Knutsson and Westin 1993).
  [[nodiscard]] Plane around(const Plane& plane, double sigma) const;

 private:
  std::size_t width_px_, height_px_, columns_, rows_;
};

}  // namespace touchline::calibrate
