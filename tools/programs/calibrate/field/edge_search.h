#pragma once

#include <cstdint>
#include <vector>

#include "core/geometry/camera_model.h"
#include "hal/replay/picture.h"

namespace touchline::calibrate {

/// A picture in linear light, one value per pixel. In linear light, the middle of a blurred edge is at half the step;
/// the tone curve of the camera would move it towards the dark side.
class LightPicture {
 public:
  /// Averages `pictures`, which must have the same size, and removes the standard tone curve (exponent 2.2).
  explicit LightPicture(const std::vector<hal::Picture>& pictures);

  [[nodiscard]] int width_px() const { return width_; }
  [[nodiscard]] int height_px() const { return height_; }
  /// Returns the light from 0 to 1, interpolated bilinearly; positions outside the picture have the value of its edge.
  [[nodiscard]] double at(double u_px, double v_px) const;

 private:
  int width_ = 0, height_ = 0;
  std::vector<float> values_;
};

/// Kind of a mark on the floor. A mark has a direction, from its beginning to its end.
enum class MarkKind : std::uint8_t {
  kBorder,  // dark field on the left, bright border on the right
  kLine     // a bright line; the mark is its center line
};
struct Mark {
  MarkKind kind = MarkKind::kBorder;
  double begin_x_m = 0, begin_y_m = 0, end_x_m = 0, end_y_m = 0;  // for an arc, both are its center
  double radius_m = 0, from_rad = 0, to_rad = 0;                  // radius 0: a straight line
  int side = -1;                                                  // 0 to 3: part of the border at -y, +x, +y, -x
  bool innermost = false;  // for a border: use the first rise from the floor, not the steepest
  bool early = false;      // long enough to be found while the camera model is a few dozen pixels off
};

// Length that is skipped at each end of a mark, because other marks meet there.
inline constexpr double kMarkEnd_m = 0.03;

double length_of(const Mark& mark);
/// Position and direction (unit vector) of the mark, `way_m` after its beginning.
struct MarkPlace {
  double x_m = 0, y_m = 0, along_x = 1, along_y = 0;
};
MarkPlace place_on(const Mark& mark, double way_m);

/// A point of a mark that was found in the picture.
struct MarkPoint {
  std::size_t mark = 0;       // index of the mark
  double x_m = 0, y_m = 0;    // position on the floor
  double u_px = 0, v_px = 0;  // position found in the picture
  double across_u = 0,
         across_v = 0;  // unit vector perpendicular to the mark in the picture; only this direction is measured
};

/// Samples each mark every `step_px` along its projection with `camera`, and searches for the edge up to `reach_px` on
/// both sides. An edge is placed where a sharp edge between the levels of both sides would have the same sum of light;
/// a line is placed at the center of its light. If another object is too near, the edge is placed where the light is
/// halfway between the levels. Points with little contrast or at the limit of the reach are left out. `tried_points`:
/// number of points tried per mark, including points outside the picture.
std::vector<MarkPoint> find_marks(const LightPicture& picture, const CameraModel& camera,
                                  const std::vector<Mark>& marks, double step_px, double reach_px,
                                  std::vector<std::size_t>* tried_points = nullptr);

}  // namespace touchline::calibrate
