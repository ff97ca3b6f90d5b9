#pragma once

#include <array>

#include "core/types.h"

namespace touchline {

enum class CameraModelKind : std::uint8_t { kFull, kPaper };

/// Pinhole, radial and tangential distortion, pose.
struct FullModelParameters {
  float fx_px = 0, fy_px = 0, cx_px = 0, cy_px = 0;
  float k1 = 0, k2 = 0, k3 = 0, p1 = 0, p2 = 0;   // Brown 1971, on normalized coordinates
  std::array<float, 3> rotation_rad{};            // rotation vector, field frame -> camera frame (z forward, y down)
  std::array<float, 3> position_m{};              // of the camera in the field frame
};

/// Klancar eq. (12)-(15), and the affine part that is left after them.
struct PaperModelParameters {
  float center_u_px = 0, center_v_px = 0;
  float focal_px = 0;                             // H of eq. (12)
  float p_per_px = 0, q_per_px = 0;               // eq. (14)
  std::array<float, 6> affine{};                  // x_m = a0 x + a1 y + a2, y_m = a3 x + a4 y + a5 of the floor
  std::array<float, 3> position_m{};              // of the camera; its height lets objects stand above the floor
};

struct CameraParameters {
  CameraModelKind kind = CameraModelKind::kFull;
  FullModelParameters full;
  PaperModelParameters paper;
};

/// A line of sight in the field frame.
struct Ray {
  std::array<float, 3> origin_m{}, direction{};
};

/// Pixel -> ray -> plane, and back. Only coordinates are transformed, never a picture.
class CameraModel {
 public:
  /// kOutOfRange: focal length or camera height not positive; kInconsistent: the affine part is singular.
  Status configure(const CameraParameters& parameters);

  [[nodiscard]] Ray ray(PixelPoint pixel) const;
  /// Where the line of sight meets the plane z = height_m (below the camera).
  [[nodiscard]] FieldPoint to_field(PixelPoint pixel, float height_m) const;
  [[nodiscard]] PixelPoint to_pixel(FieldPoint point, float height_m) const;
  /// Square root of the area in pixels that a square meter at this place and height covers.
  [[nodiscard]] float scale_px_per_m(FieldPoint point, float height_m) const;
};

}  // namespace touchline
