#pragma once

#include <array>
#include <string>

#include "core/geometry/brown_distortion.h"
#include "core/geometry/camera_model.h"
#include "core/marker/matcher.h"
#include "hal/replay/picture.h"
#include "hal/result.h"

// Makes pictures like figures 11 and 12 of Klancar's paper, for people to look at. The pipeline never rectifies a
// picture.
namespace touchline::rectify {

/// A pixel position in double precision.
using Point = std::array<double, 2>;

/// The lens distortion of a camera (the full model includes tangential distortion): maps pixels of its picture to
/// pixels of a picture in which straight lines are straight, and back. Both pictures have the same center and the same
/// scale there.
class LensMap {
 public:
  /// Uses the model selected by `camera.kind`, which CameraModel must accept.
  explicit LensMap(const CameraParameters& camera);

  /// Remove and apply the distortion: eq. (12) and (13), or Brown's model.
  [[nodiscard]] Point undistorted(const Point& pixel) const;
  [[nodiscard]] Point distorted(const Point& straight) const;

 private:
  // `radius` maps a radius with the paper's model; `brown` maps a point with Brown's.
  template <class Radius, class Brown>
  [[nodiscard]] Point mapped(const Point& from, Radius radius, Brown brown) const;

  CameraParameters camera_;
  BrownDistortion distortion_;
};

/// Position of a rectified picture: pixel (0, 0) is at `left`, `top`, and a pixel is 1 / `scale` wide.
struct Raster {
  double left = 0, top = 0, scale = 1;
  std::uint32_t width_px = 0, height_px = 0;
};

/// Figure 12 (a): corrects the lens distortion and keeps the perspective. The raster, in straightened pixels, contains
/// the whole picture, up to kLargestStretch times its width and height.
hal::Picture straighten(const hal::Picture& picture, const LensMap& lens, Raster& raster);
inline constexpr double kLargestStretch = 2.0;

/// Figure 12 (b): corrects lens distortion and perspective. Shows the floor to scale, x to the right and y up, with
/// `margin_m` around the field and its goals. The raster is in meters; its rows run in the direction of -y. kFull: the
/// picture would be larger than kLargestSide_px.
Result<hal::Picture> rectify_floor(const hal::Picture& picture, const CameraModel& camera, const FieldParameters& field,
                                   double margin_m, double scale_px_per_m, Raster& raster);
inline constexpr std::uint32_t kLargestSide_px = 8192;

/// Draws grid lines through the center of the field, `spacing_m` apart, and the outline of the field into the pictures
/// above.
void draw_grid(const CameraModel& camera, const LensMap& lens, const FieldParameters& field, double spacing_m,
               const Raster& raster, hal::Picture& straight);
void draw_grid(const FieldParameters& field, double spacing_m, const Raster& raster, hal::Picture& floor);

}  // namespace touchline::rectify
