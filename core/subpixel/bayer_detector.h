#pragma once

#include <array>
#include <cstddef>

#include "core/types.h"

namespace touchline {

/// Which colors the pixels of a picture measured; the others were interpolated from the neighbors. Red is measured
/// where column and row are even or odd like these, blue where both differ, and green everywhere else.
struct BayerPattern {
  bool found = false;                        // false: every pixel measured all colors, or it is not known which
  std::uint8_t red_column = 0, red_row = 0;  // 0 or 1
};

/// Finds out whether the red and blue of pictures were interpolated from a Bayer pattern, as in Popescu and Farid,
/// "Exposing Digital Forgeries in Color Filter Array Interpolated Images" (2005): an interpolated value is close to the
/// mean of its two neighbors in the row, a measured one has noise of its own. So the second differences of red are
/// smaller in every second column, and those of blue in the other ones. Nothing else has both signs: shared chroma
/// treats red and blue alike, and a sensor that measures all colors treats all columns alike. The same holds for rows.
class BayerDetector {
 public:
  /// Examines 512 pixels of a picture that the scan accepted, and 1024 more if it has a pattern; other ones in each
  /// picture.
  void examine(const Frame& frame);
  void reset() { *this = BayerDetector(); }

  /// None is found in YUV, in which chroma is shared.
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
