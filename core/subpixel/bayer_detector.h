#pragma once

#include <array>
#include <cstddef>

#include "core/types.h"

namespace touchline {

/// Which color each pixel of a picture measured; the other two were interpolated from neighbors. Red is measured where
/// column and row have these parities, blue where both parities differ, and green elsewhere.
struct BayerPattern {
  bool found = false;                        // false: every pixel measured all colors, or the pattern is unknown
  std::uint8_t red_column = 0, red_row = 0;  // 0 or 1
};

/// Detects whether red and blue of pictures were interpolated from a Bayer pattern, as in Popescu and Farid, "Exposing
/// Digital Forgeries in Color Filter Array Interpolated Images" (2005): an interpolated value is close to the mean of
/// its two neighbors in the row, and a measured value has independent noise. The second differences of red are
/// therefore smaller in every second column, and those of blue in the other columns. Nothing else causes both: shared
/// chroma affects red and blue equally, and a sensor that measures all colors affects all columns equally. Rows are
/// tested in the same way.
class BayerDetector {
 public:
  /// Examines 512 pixels of a picture, and 1024 more if it has a pattern. Each picture contributes different pixels.
  /// The scan must have accepted the picture.
  void examine(const Frame& frame);
  void reset() { *this = BayerDetector(); }

  /// Never found in YUV, because chroma is shared there.
  [[nodiscard]] const BayerPattern& pattern() const { return pattern_; }

 private:
  // Sums of second differences: red, blue; even and odd.
  using Differences = std::array<std::array<float, 2>, 2>;

  void add_rows(const Frame& frame, std::size_t picture);
  void add_columns(const Frame& frame, std::size_t picture);

  Differences along_rows_{}, along_columns_{};
  std::size_t pictures_ = 0;
  BayerPattern pattern_;
};

}  // namespace touchline
