#pragma once

#include <array>
#include <bitset>
#include <cstddef>
#include <limits>

#include "core/geometry/camera_model.h"
#include "core/types.h"

namespace touchline {

/// Line of sight of a pixel.
class SightLine {
 public:
  SightLine() = default;
  SightLine(std::array<float, 3> camera_m, float x_per_m, float y_per_m, float scale)
      : camera_m_(camera_m), x_per_m_(x_per_m), y_per_m_(y_per_m), scale_(scale) {}

  /// Returns where the line meets the plane at this height in m, which is below the camera.
  [[nodiscard]] FieldPoint at(float height_m) const {
    const float fall_m = camera_m_[2] - height_m;
    return {camera_m_[0] + fall_m * x_per_m_, camera_m_[1] + fall_m * y_per_m_};
  }
  /// Returns the square root of the area in pixels of one square meter of the plane at this point.
  [[nodiscard]] float scale_px_per_m(float height_m) const { return scale_ / (camera_m_[2] - height_m); }

 private:
  std::array<float, 3> camera_m_{};
  float x_per_m_ = 0, y_per_m_ = 0;  // outward displacement of the point per meter of height
  float scale_ = 0;                  // scale times the height below the camera, which is constant along the line
};

/// Table of the lines of sight of the pixels in a rectangle of the picture. It takes a fifth of the camera model's
/// time: it has the lines at the nodes of a grid of 32 by 32 cells, and interpolates between them cubically (Keys
/// 1981).
class SightTable {
 public:
  /// Largest interpolation error of a point on the floor; cells with a larger error are left out.
  static constexpr float kLargestError_px = 0.01f;

  /// Fills the table for the rectangle from `low` to `high`, in px.
  void configure(const CameraModel& camera, PixelPoint low, PixelPoint high);

  /// Returns false and leaves `out` unchanged if the table does not contain the pixel, or before configure().
  [[nodiscard]] bool find(PixelPoint pixel, SightLine& out) const;

 private:
  static constexpr std::size_t kCells = 32;
  // One more node on each side, because interpolation also uses the nodes around a cell.
  static constexpr std::size_t kNodes = kCells + 3;
  enum Value : std::size_t { kSlopeX, kSlopeY, kScaleOfSight, kValues };  // as in SightLine

  [[nodiscard]] std::array<float, kValues> interpolate(std::size_t row, std::size_t column, float down,
                                                       float right) const;

  using Grid = std::array<std::array<float, kNodes>, kNodes>;  // by row and column
  std::array<Grid, kValues> grids_{};
  std::bitset<kCells * kCells> is_known_;
  // NaN before configure(), so that no pixel counts as inside.
  static constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
  PixelPoint low_, cells_per_px_{kUnknown, kUnknown};
  std::array<float, 3> camera_m_{};
};

}  // namespace touchline
