#pragma once

#include <array>
#include <cstddef>
#include <limits>

#include "core/geometry/camera_model.h"
#include "core/types.h"

namespace touchline {

/// Places on the field of pixels in a rectangle of the picture, for any height, in an eighth of the time that the
/// camera model needs: lines of sight of a grid of pixels, and between them bilinear interpolation.
///
/// The error grows with the square of the grid's step, which is a 32nd of the rectangle, and with the lens's bend: in a
/// picture of 640 x 480 from a lens of 85 degrees it is below 0.4 px at the corners
/// (tests/geometry/place_table_test.cpp).
class PlaceTable {
 public:
  /// The rectangle from `low` to `high`, in px.
  void configure(const CameraModel& camera, PixelPoint low, PixelPoint high);

  /// False, leaving `out` as it is, for a pixel outside of the rectangle, and before configure(). The height is in m,
  /// below the camera.
  [[nodiscard]] bool find(PixelPoint pixel, float height_m, FieldPoint& out) const;

 private:
  static constexpr std::size_t kCells = 32;

  // Meters from the point below the camera, per meter of height: a line of sight moves outwards as it falls.
  struct Slope {
    float x = 0, y = 0;
  };

  std::array<std::array<Slope, kCells + 1>, kCells + 1> slopes_{};  // by row and column
  // Not a number before configure(), so that no pixel is inside.
  static constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
  PixelPoint low_, cells_per_px_{kUnknown, kUnknown};
  std::array<float, 3> camera_m_{};
};

}  // namespace touchline
