#include "tools/programs/calibrate/field/field_overlay.h"

#include <algorithm>

#include "tools/programs/calibrate/imaging/camera_picture.h"

namespace touchline::calibrate {

void draw_field(const CameraModel& camera, const FieldParameters& field, const std::vector<Mark>& marks,
                const std::vector<FloorPoint>& points, hal::Picture& picture) {
  const auto draw = [&](const Mark& mark) {
    constexpr int kSteps = 1500;  // steps along a mark, less than a pixel apart on any supported picture of a field
    const double length = length_of(mark);
    for (int i = 0; i <= kSteps; ++i) {
      const MarkPlace at = place_on(mark, length * i / kSteps);
      const PixelPoint p = camera.to_pixel({static_cast<float>(at.x_m), static_cast<float>(at.y_m)}, 0.0f);
      set_pixel(picture, static_cast<double>(p.u_px), static_cast<double>(p.v_px), {255, 0, 0});
    }
  };
  std::for_each(marks.begin(), marks.end(), draw);
  const double x = static_cast<double>(field.length_m) / 2, goal = static_cast<double>(field.goal_width_m) / 2;
  if (goal > 0 && field.goal_depth_m > 0) {
    for (const double side : {-1.0, 1.0}) {
      const double back = side * (x + static_cast<double>(field.goal_depth_m));
      draw({MarkKind::kLine, side * x, -goal, back, -goal});
      draw({MarkKind::kLine, back, -goal, back, goal});
      draw({MarkKind::kLine, back, goal, side * x, goal});
    }
  }
  for (const FloorPoint& p : points) {
    for (int i = -4; i <= 4; ++i) {
      set_pixel(picture, p.u_px + i, p.v_px, {0, 255, 0});
      set_pixel(picture, p.u_px, p.v_px + i, {0, 255, 0});
    }
  }
}

}  // namespace touchline::calibrate
