#include "core/geometry/sight_table.h"

#include <cmath>
#include <cstring>

namespace touchline {
namespace {

using Four [[gnu::vector_size(16)]] = float;

// Returns the interpolation weights of four neighboring nodes, for a position between the middle two.
Four weights(float part) {
  const float rest = 1.0f - part;
  return Four{-0.5f * part * rest * rest, 1.0f + part * part * (1.5f * part - 2.5f),
              1.0f + rest * rest * (1.5f * rest - 2.5f), -0.5f * rest * part * part};
}

}  // namespace

void SightTable::configure(const CameraModel& camera, PixelPoint low, PixelPoint high) {
  constexpr auto kCount = static_cast<float>(kCells);
  low_ = low;
  cells_per_px_ = {kCount / (high.u_px - low.u_px), kCount / (high.v_px - low.v_px)};
  const auto pixel_at = [&](float row, float column) {
    return PixelPoint{low.u_px + column / cells_per_px_.u_px, low.v_px + row / cells_per_px_.v_px};
  };
  for (std::size_t row = 0; row < kNodes; ++row) {
    for (std::size_t column = 0; column < kNodes; ++column) {
      const PixelPoint pixel = pixel_at(static_cast<float>(row) - 1.0f, static_cast<float>(column) - 1.0f);
      const Ray ray = camera.ray(pixel);
      camera_m_ = ray.origin_m;
      grids_[kSlopeX][row][column] = -ray.direction[0] / ray.direction[2];
      grids_[kSlopeY][row][column] = -ray.direction[1] / ray.direction[2];
      grids_[kScaleOfSight][row][column] = camera_m_[2] * camera.scale_px_per_m(camera.to_field(pixel, 0.0f), 0.0f);
    }
  }
  // Check the error in the middle of each cell, where it is largest.
  is_known_.set();
  for (std::size_t row = 0; row < kCells; ++row) {
    for (std::size_t column = 0; column < kCells; ++column) {
      const PixelPoint middle = pixel_at(static_cast<float>(row) + 0.5f, static_cast<float>(column) + 0.5f);
      SightLine line;
      const PixelPoint seen = find(middle, line) ? camera.to_pixel(line.at(0.0f), 0.0f) : PixelPoint{};
      const float error_px = std::hypot(seen.u_px - middle.u_px, seen.v_px - middle.v_px);
      is_known_[row * kCells + column] = error_px <= kLargestError_px;
    }
  }
}

std::array<float, SightTable::kValues> SightTable::interpolate(std::size_t row, std::size_t column, float down,
                                                               float right) const {
  const Four across = weights(right), along = weights(down);
  std::array<float, kValues> out;
  // gcc 12 unrolls no loops at -O2.
  _Pragma("GCC unroll 3") for (std::size_t value = 0; value < kValues; ++value) {
    Four sum{};
    _Pragma("GCC unroll 4") for (std::size_t i = 0; i < 4; ++i) {
      Four nodes;
      std::memcpy(&nodes, &grids_[value][row + i][column], sizeof nodes);
      sum += along[i] * nodes;
    }
    sum *= across;
    out[value] = (sum[0] + sum[1]) + (sum[2] + sum[3]);
  }
  return out;
}

bool SightTable::find(PixelPoint pixel, SightLine& out) const {
  constexpr auto kCount = static_cast<float>(kCells);
  const float u = (pixel.u_px - low_.u_px) * cells_per_px_.u_px, v = (pixel.v_px - low_.v_px) * cells_per_px_.v_px;
  if (!(u >= 0.0f && v >= 0.0f && u < kCount && v < kCount)) return false;
  const auto column = static_cast<std::size_t>(u), row = static_cast<std::size_t>(v);
  if (!is_known_[row * kCells + column]) return false;
  const auto values = interpolate(row, column, v - static_cast<float>(row), u - static_cast<float>(column));
  out = {camera_m_, values[kSlopeX], values[kSlopeY], values[kScaleOfSight]};
  return true;
}

}  // namespace touchline
