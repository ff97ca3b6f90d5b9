#pragma once

#include <array>
#include <bitset>
#include <cstddef>
#include <limits>

#include "core/geometry/camera_model.h"
#include "core/types.h"

namespace touchline {

/// The line of sight of a pixel.
class SightLine {
 public:
  SightLine() = default;
  SightLine(std::array<float, 3> camera_m, float x_per_m, float y_per_m, float scale)
      : camera_m_(camera_m), x_per_m_(x_per_m), y_per_m_(y_per_m), scale_(scale) {}

  /// Where it meets the plane at this height, in m, which is below the camera.
  [[nodiscard]] FieldPoint at(float height_m) const {
    const float fall_m = camera_m_[2] - height_m;
    return {camera_m_[0] + fall_m * x_per_m_, camera_m_[1] + fall_m * y_per_m_};
  }
  /// Square root of the area in pixels of one square meter of the plane there.
  [[nodiscard]] float scale_px_per_m(float height_m) const { return scale_ / (camera_m_[2] - height_m); }

 private:
  std::array<float, 3> camera_m_{};
  float x_per_m_ = 0, y_per_m_ = 0;  // motion outwards, per meter of height
  float scale_ = 0;                  // times the height below the camera: constant along the line
};

/// Lines of sight of the pixels in a rectangle of the picture, in a fifth of the time that the camera model needs:
/// those of a grid of 32 by 32 cells, and between them cubic interpolation (Keys 1981).
class SightTable {
 public:
  /// Error that a place may have; cells with a larger one are left out.
  static constexpr float kLargestError_px = 0.01f;

  /// The rectangle from `low` to `high`, in px.
  void configure(const CameraModel& camera, PixelPoint low, PixelPoint high);

  /// False, leaving `out` as it is, for a pixel that the table does not know, and before configure().
  [[nodiscard]] bool find(PixelPoint pixel, SightLine& out) const;

 private:
  static constexpr std::size_t kCells = 32;
  // One more on each side, because interpolation takes the nodes around a cell, too.
  static constexpr std::size_t kNodes = kCells + 3;
  enum Value : std::size_t { kSlopeX, kSlopeY, kScaleOfSight, kValues };  // as in SightLine

  [[nodiscard]] std::array<float, kValues> interpolate(std::size_t row, std::size_t column, float down,
                                                       float right) const;

  using Grid = std::array<std::array<float, kNodes>, kNodes>;  // by row and column
  std::array<Grid, kValues> grids_{};
  std::bitset<kCells * kCells> is_known_;
  // Not a number before configure(), so that no pixel is inside.
  static constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
  PixelPoint low_, cells_per_px_{kUnknown, kUnknown};
  std::array<float, 3> camera_m_{};
};

}  // namespace touchline
