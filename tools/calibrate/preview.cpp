#include "tools/calibrate/preview.h"

#include <array>
#include <cmath>

namespace touchline::calibrate {
namespace {

using Rgb = std::array<std::uint8_t, 3>;

void put(hal::Picture& picture, double u, double v, const Rgb& color) {
  const long column = std::lround(u), row = std::lround(v);
  if (column < 0 || row < 0 || column >= static_cast<long>(picture.width_px) ||
      row >= static_cast<long>(picture.height_px)) {
    return;
  }
  const std::size_t at = 3 * (static_cast<std::size_t>(row) * picture.width_px + static_cast<std::size_t>(column));
  for (std::size_t c = 0; c < 3; ++c) picture.rgb8[at + c] = color[c];
}

}  // namespace

void draw_field(const CameraModel& camera, const FieldParameters& field, const std::vector<FloorPoint>& points,
                hal::Picture& picture) {
  const auto line = [&](float x0, float y0, float x1, float y1) {
    constexpr int kSteps = 1500;  // closer than a pixel on any supported picture of a field
    for (int i = 0; i <= kSteps; ++i) {
      const float t = static_cast<float>(i) / kSteps;
      const PixelPoint p = camera.to_pixel({x0 + t * (x1 - x0), y0 + t * (y1 - y0)}, 0.0f);
      put(picture, static_cast<double>(p.u_px), static_cast<double>(p.v_px), {255, 0, 0});
    }
  };
  const float x = field.length_m / 2, y = field.width_m / 2, goal = field.goal_width_m / 2;
  line(-x, -y, x, -y);
  line(x, -y, x, y);
  line(x, y, -x, y);
  line(-x, y, -x, -y);
  line(0, -y, 0, y);
  for (const float side : {-1.0f, 1.0f}) {
    const float back = side * (x + field.goal_depth_m);
    line(side * x, -goal, back, -goal);
    line(back, -goal, back, goal);
    line(back, goal, side * x, goal);
  }
  for (const FloorPoint& p : points) {
    for (int i = -4; i <= 4; ++i) {
      put(picture, p.u_px + i, p.v_px, {0, 255, 0});
      put(picture, p.u_px, p.v_px + i, {0, 255, 0});
    }
  }
}

}  // namespace touchline::calibrate
