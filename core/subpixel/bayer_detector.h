#pragma once

#include <array>
#include <cstddef>

#include "core/types.h"

namespace touchline {

/// Finds out whether the red and blue of pictures were interpolated from a Bayer pattern, as in Popescu and Farid,
/// "Exposing Digital Forgeries in Color Filter Array Interpolated Images" (2005): an interpolated value is close to the
/// mean of its two neighbors in the row, a measured one has noise of its own. So the second differences of red are
/// smaller in every second column, and those of blue in the other ones. Nothing else has both signs: shared chroma
/// treats red and blue alike, and a sensor that measures all colors treats all columns alike.
class BayerDetector {
 public:
  /// Examines 512 pixels of a picture that the scan accepted, other ones in each picture.
  void examine(const Frame& frame);
  void reset() { *this = BayerDetector(); }

  /// Always false for YUV, in which chroma is shared.
  [[nodiscard]] bool found() const { return found_; }

 private:
  std::array<std::array<float, 2>, 2> differences_{};  // red, blue; even and odd columns
  std::size_t pictures_ = 0;
  bool found_ = false;
};

}  // namespace touchline
