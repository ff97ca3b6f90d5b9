#pragma once

#include <cstddef>
#include <vector>

#include "core/types.h"

namespace touchline::devices {

/// Brightness of a picture: luma of YUV, green of RGB, 0 to 255; each value is the mean of a square of pixels.
struct LumaPicture {
  std::size_t width = 0, height = 0;
  std::vector<float> value;  // row by row

  [[nodiscard]] float at(std::size_t x, std::size_t y) const { return value[y * width + x]; }
};

/// Greatest number of columns of a LumaPicture. Small pictures are fast to search, and means have less noise.
inline constexpr std::size_t kMaxLumaWidth = 640;
/// Returns the side in pixels of the squares to average, so that a frame of width `width_px` gives a LumaPicture of at
/// most kMaxLumaWidth columns.
constexpr std::size_t luma_square(std::size_t width_px) { return (width_px + kMaxLumaWidth - 1) / kMaxLumaWidth; }

/// Averages the brightness of a frame in squares; columns and rows that do not fill a square are left out. `square`: at
/// least 1.
void read_luma(const Frame& frame, std::size_t square, LumaPicture& out);

/// Reads the brightness of single pixels.
class LumaReader {
 public:
  explicit LumaReader(const Frame& frame);
  [[nodiscard]] float operator()(std::size_t u, std::size_t v) const {
    return static_cast<float>(first_[v * stride_ + u * step_]);
  }

 private:
  const std::uint8_t* first_;
  std::size_t stride_, step_;
};

}  // namespace touchline::devices
