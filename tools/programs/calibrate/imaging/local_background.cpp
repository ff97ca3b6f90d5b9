#include "tools/programs/calibrate/imaging/local_background.h"

#include <algorithm>
#include <array>

#include "tools/programs/statistics/statistics.h"

namespace touchline::calibrate {

LocalBackground::LocalBackground(const ChannelImage& image, const std::vector<std::uint8_t>& inside)
    : columns_((image.width_px + kBlock_px - 1) / kBlock_px), rows_((image.height_px + kBlock_px - 1) / kBlock_px) {
  const auto cells = static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_);
  std::vector<Channels> block(cells);
  std::vector<bool> known(cells, false);
  for (int y = 0; y < rows_; ++y) {
    for (int x = 0; x < columns_; ++x) {
      std::array<std::vector<std::uint8_t>, 3> values;
      for (int v = y * kBlock_px; v < std::min(image.height_px, (y + 1) * kBlock_px); ++v) {
        for (int u = x * kBlock_px; u < std::min(image.width_px, (x + 1) * kBlock_px); ++u) {
          if (inside[image.index(u, v)] == 0) continue;
          for (std::size_t c = 0; c < 3; ++c) values[c].push_back(image.at(u, v)[c]);
        }
      }
      if (values[0].size() < kBlock_px) continue;
      known[cell(x, y)] = true;
      for (std::size_t c = 0; c < 3; ++c) block[cell(x, y)][c] = statistics::median(values[c]);
    }
  }
  background_.resize(cells);
  for (int y = 0; y < rows_; ++y) {
    for (int x = 0; x < columns_; ++x) {
      std::array<std::vector<std::uint8_t>, 3> values;
      for (int dy = -2; dy <= 2; ++dy) {
        for (int dx = -2; dx <= 2; ++dx) {
          if (x + dx < 0 || y + dy < 0 || x + dx >= columns_ || y + dy >= rows_ || !known[cell(x + dx, y + dy)]) {
            continue;
          }
          for (std::size_t c = 0; c < 3; ++c) values[c].push_back(block[cell(x + dx, y + dy)][c]);
        }
      }
      if (values[0].empty()) continue;
      for (std::size_t c = 0; c < 3; ++c) background_[cell(x, y)][c] = statistics::median(values[c]);
    }
  }
}

}  // namespace touchline::calibrate
