#include "core/geometry/place_table.h"

namespace touchline {

void PlaceTable::configure(const CameraModel& camera, PixelPoint low, PixelPoint high) {
  constexpr auto kCount = static_cast<float>(kCells);
  low_ = low;
  cells_per_px_ = {kCount / (high.u_px - low.u_px), kCount / (high.v_px - low.v_px)};
  for (std::size_t row = 0; row <= kCells; ++row) {
    for (std::size_t column = 0; column <= kCells; ++column) {
      const Ray ray = camera.ray({low.u_px + static_cast<float>(column) / cells_per_px_.u_px,
                                  low.v_px + static_cast<float>(row) / cells_per_px_.v_px});
      camera_m_ = ray.origin_m;
      slopes_[row][column] = {-ray.direction[0] / ray.direction[2], -ray.direction[1] / ray.direction[2]};
    }
  }
}

bool PlaceTable::find(PixelPoint pixel, float height_m, FieldPoint& out) const {
  constexpr auto kCount = static_cast<float>(kCells);
  const float u = (pixel.u_px - low_.u_px) * cells_per_px_.u_px, v = (pixel.v_px - low_.v_px) * cells_per_px_.v_px;
  if (!(u >= 0.0f && v >= 0.0f && u < kCount && v < kCount)) return false;
  const auto column = static_cast<std::size_t>(u), row = static_cast<std::size_t>(v);
  const float right = u - static_cast<float>(column), down = v - static_cast<float>(row);
  const auto between = [](const Slope& a, const Slope& b, float part) {
    return Slope{a.x + part * (b.x - a.x), a.y + part * (b.y - a.y)};
  };
  const Slope above = between(slopes_[row][column], slopes_[row][column + 1], right);
  const Slope below = between(slopes_[row + 1][column], slopes_[row + 1][column + 1], right);
  const Slope slope = between(above, below, down);
  const float fall_m = camera_m_[2] - height_m;
  out = {camera_m_[0] + fall_m * slope.x, camera_m_[1] + fall_m * slope.y};
  return true;
}

}  // namespace touchline
