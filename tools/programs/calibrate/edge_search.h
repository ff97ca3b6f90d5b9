#pragma once

#include <cstdint>
#include <vector>

#include "core/geometry/camera_model.h"
#include "hal/replay/picture.h"

namespace touchline::calibrate {

/// Light as the sensor counted it, a value a pixel: half of it is halfway across a blurred edge, which the camera's
/// tone curve would move towards the dark side.
class LightPicture {
 public:
  /// `pictures` of one size, averaged. Their tone curve is taken as the standard one (exponent 2.2).
  explicit LightPicture(const std::vector<hal::Picture>& pictures);

  [[nodiscard]] int width_px() const { return width_; }
  [[nodiscard]] int height_px() const { return height_; }
  /// Bilinear; the border's value beyond the border. 0 to 1.
  [[nodiscard]] double at(double u_px, double v_px) const;

 private:
  int width_ = 0, height_ = 0;
  std::vector<float> values_;
};

/// What is drawn on the floor along a way.
enum class MarkKind : std::uint8_t {
  kBorder,  // dark field to the left of the way, bright border to its right
  kLine     // a bright line whose middle is the way
};
struct Mark {
  MarkKind kind = MarkKind::kBorder;
  double begin_x_m = 0, begin_y_m = 0, end_x_m = 0, end_y_m = 0;  // of an arc: both its center
  double radius_m = 0, from_rad = 0, to_rad = 0;                  // radius 0: straight
  int side = -1;           // 0 to 3: it is part of the border's side at -y, +x, +y, -x
  bool innermost = false;  // of a border: the floor's first rise to something bright counts, not the steepest
  bool early = false;      // so long that it is found when the camera is known to a few dozen pixels only
};

// Ends of marks, where others meet them, are left out.
inline constexpr double kMarkEnd_m = 0.03;

double length_of(const Mark& mark);
/// Place, and direction of the way (unit vector), `way_m` after the mark's begin.
struct MarkPlace {
  double x_m = 0, y_m = 0, along_x = 1, along_y = 0;
};
MarkPlace place_on(const Mark& mark, double way_m);

/// A point of a mark that was found in the picture.
struct MarkPoint {
  std::size_t mark = 0;               // index
  double x_m = 0, y_m = 0;            // of the floor
  double u_px = 0, v_px = 0;          // where it was found
  double across_u = 0, across_v = 0;  // unit vector across the mark, in the picture; along it nothing is known
};

/// Walks along the marks as `camera` sees them, a point every `step_px`, and looks up to `reach_px` to both sides for
/// the place where the light passes halfway between the levels of both sides (of both flanks of a line). Points with
/// little contrast, or at the end of the reach, are left out. `looked_at`: how many points of each mark were tried,
/// those outside of the picture included.
std::vector<MarkPoint> find_marks(const LightPicture& picture, const CameraModel& camera,
                                  const std::vector<Mark>& marks, double step_px, double reach_px,
                                  std::vector<std::size_t>* looked_at = nullptr);

}  // namespace touchline::calibrate
