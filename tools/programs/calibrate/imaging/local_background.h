#pragma once

#include <vector>

#include "tools/programs/calibrate/imaging/channel_image.h"

namespace touchline::calibrate {

/// Estimates the background color around each pixel: the median of each block of 16 x 16 pixels, then the median of 5 x
/// 5 blocks, which cover more area than a robot, a line or a logo. Blocks with fewer than 16 pixels inside the mask are
/// ignored; the color is black where no block is left.
class LocalBackground {
 public:
  LocalBackground(const ChannelImage& image, const std::vector<std::uint8_t>& inside);
  [[nodiscard]] const Channels& at(int u, int v) const { return background_[cell(u / kBlock_px, v / kBlock_px)]; }

 private:
  static constexpr int kBlock_px = 16;
  [[nodiscard]] std::size_t cell(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(x);
  }
  int columns_, rows_;
  std::vector<Channels> background_;
};

}  // namespace touchline::calibrate
