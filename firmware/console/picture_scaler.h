#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/types.h"

namespace touchline::console {

/// Returns the size of a picture whose pixels are means of divisor x divisor pixels of the camera; surplus pixels at
/// the right and lower edge are dropped.
constexpr std::uint16_t scaled(std::uint16_t size_px, int divisor) {
  return static_cast<std::uint16_t>(size_px / divisor);
}

/// Computes rows of a reduced picture, with the full range of values from 0 to 255 (as in JPEG).
///
/// R, G, B: packed. YUV: a row of luma, or of chroma, which always has half the width and half the height.
class PictureScaler {
 public:
  /// `frame` must outlive the scaler's use; `divisor` is 1 to 8.
  PictureScaler(const Frame& frame, int divisor) : frame_(frame), divisor_(divisor) {}

  [[nodiscard]] std::uint16_t width_px() const { return scaled(frame_.width_px, divisor_); }
  [[nodiscard]] std::uint16_t height_px() const { return scaled(frame_.height_px, divisor_); }

  /// Writes row v of the reduced picture as R, G, B. `out`: 3 * width_px() bytes.
  void rgb_row(std::size_t v, std::span<std::uint8_t> out) const;
  /// Writes a row of luma. `out`: at least width_px() bytes; the rest repeats the last one.
  void luma_row(std::size_t v, std::span<std::uint8_t> out) const;
  /// Writes a row of U (channel 1) or V (channel 2). `out` is as for luma, with half the width rounded up.
  void chroma_row(std::size_t v, std::size_t channel, std::span<std::uint8_t> out) const;

 private:
  void mean_row(std::size_t channel, std::size_t v, std::size_t side, std::size_t count, std::uint8_t* out,
                std::size_t step) const;

  const Frame& frame_;
  const int divisor_;
};

}  // namespace touchline::console
