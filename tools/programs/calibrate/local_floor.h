#pragma once

#include <vector>

#include "tools/programs/calibrate/channel_image.h"

namespace touchline::calibrate {

/// The usual color around a pixel: medians of blocks of 16 x 16 pixels, and the median of five by five of them, more
/// than a robot, a line or a logo covers. Blocks with few pixels inside count for nothing; black where none counts.
class LocalFloor {
 public:
  LocalFloor(const ChannelImage& image, const std::vector<std::uint8_t>& inside);
  [[nodiscard]] const Channels& at(int u, int v) const { return floor_[cell(u / kBlock_px, v / kBlock_px)]; }

 private:
  static constexpr int kBlock_px = 16;
  [[nodiscard]] std::size_t cell(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(x);
  }
  int columns_, rows_;
  std::vector<Channels> floor_;
};

}  // namespace touchline::calibrate
