#include "core/light/light_reference.h"

#include <algorithm>

namespace touchline {
namespace {

// Smallest value of a channel that counts as saturated. In YUV of limited range it is the smallest such luma.
constexpr std::uint8_t kSaturated = 250, kSaturatedLimitedLuma = 231;
constexpr int kPixels = 4;

// Converts sums of kPixels samples.
void to_rgb(std::array<int, 3>& sum, ColorSpace yuv) {
  for (std::size_t c = 0; c < 3; ++c) sum[c] -= black_value(yuv, c) * kPixels;
  const std::array<int, 3> rgb = yuv_to_rgb(yuv).of(sum[0], sum[1], sum[2]);
  for (std::size_t c = 0; c < 3; ++c) {
    sum[c] = std::clamp((rgb[c] + YuvToRgb::kOne / 2) / YuvToRgb::kOne, 0, 255 * kPixels);
  }
}

}  // namespace

ReferenceGrid ReferenceGrid::of(std::uint16_t width_px, std::uint16_t height_px) {
  static_assert(kTileWidth == 2 * kTileHeight);
  const auto cells_along = [](unsigned picture_px, unsigned cell_px) { return (picture_px + cell_px - 1) / cell_px; };
  ReferenceGrid grid;
  unsigned cell_px = 0;
  do {
    cell_px += kTileWidth;
    grid = {static_cast<std::uint16_t>(cells_along(width_px, cell_px)),
            static_cast<std::uint16_t>(cells_along(height_px, cell_px)), static_cast<std::uint16_t>(cell_px)};
  } while (grid.cells() > kMaxReferenceCells);
  return grid;
}

void sample_cells(const Frame& frame, const ReferenceGrid& grid, std::size_t row, CellColors& out) {
  const PixelFormatInfo& info = info_of(frame.format);
  const std::uint8_t limit = info.space == ColorSpace::kYuv ? kSaturatedLimitedLuma : kSaturated;
  const std::size_t side = grid.side_px;
  // If the picture's edge cuts off a cell, pixels beyond the edge are read at the edge.
  const auto place = [side](std::size_t cell, std::size_t i, std::size_t size_px) {
    return std::min(cell * side + side / 4 + i * side / 2, size_px - 1);
  };
  std::array<std::array<const std::uint8_t*, 3>, 2> lines{};
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::size_t v = place(row, i, frame.height_px);
    for (std::size_t c = 0; c < 3; ++c) {
      const ChannelLayout& channel = info.channel[c];
      lines[i][c] = frame.plane[channel.plane] + (v >> channel.shift_v) * frame.stride_bytes[channel.plane];
    }
  }
  for (std::size_t column = 0; column < grid.columns; ++column) {
    const std::array<std::size_t, 2> u{place(column, 0, frame.width_px), place(column, 1, frame.width_px)};
    std::array<int, 3> sum{};
    std::array<std::uint8_t, 3> most{};
    for (std::size_t c = 0; c < 3; ++c) {
      const ChannelLayout& channel = info.channel[c];
      for (const auto& line : lines) {
        for (const std::size_t at : u) {
          const std::uint8_t value = line[c][channel.byte(at)];
          sum[c] += value;
          most[c] = std::max(most[c], value);
        }
      }
    }
    if (is_yuv(info.space)) {
      to_rgb(sum, info.space);
      most.fill(most[0]);
    }
    for (std::size_t c = 0; c < 3; ++c) {
      out.sum[c][row * grid.columns + column] = most[c] < limit ? static_cast<std::uint16_t>(sum[c]) : std::uint16_t{0};
    }
  }
}

}  // namespace touchline
