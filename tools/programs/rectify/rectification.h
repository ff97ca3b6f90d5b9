#pragma once

#include <array>
#include <string>

#include "core/geometry/brown_distortion.h"
#include "core/geometry/camera_model.h"
#include "core/marker/matcher.h"
#include "core/status.h"
#include "hal/replay/picture.h"

// Pictures as figures 11 and 12 of Klancar's paper show them. The pipeline never rectifies a picture: only a person
// wants to see one.
namespace touchline::rectify {

/// A point of a picture in double precision, px.
using Point = std::array<double, 2>;

/// The radial (full model: and tangential) part of a camera: pixels of its picture against those of one in which
/// straight lines of the floor are straight. Both pictures have the same center and the same scale there.
class LensMap {
 public:
  /// Takes the model that `camera.kind` names; it must be one that CameraModel accepts.
  explicit LensMap(const CameraParameters& camera);

  /// Eq. (12), (13), or Brown's.
  [[nodiscard]] Point straightened(const Point& pixel) const;
  [[nodiscard]] Point bent(const Point& straight) const;

 private:
  // `radius`: of the paper's model, from that of the one picture to that of the other; `brown`: the same for points.
  template <class Radius, class Brown>
  [[nodiscard]] Point mapped(const Point& from, Radius radius, Brown brown) const;

  CameraParameters camera_;
  BrownDistortion distortion_;
};

/// Where a rectified picture lies: its pixel (0, 0) shows `left`, `top`; a pixel is 1 / `scale` wide.
struct Raster {
  double left = 0, top = 0, scale = 1;
  std::uint32_t width_px = 0, height_px = 0;
};

/// Figure 12 (a): radial distortion corrected, perspective left. The raster, in straightened pixels, holds the whole
/// picture, but is not more than kLargestStretch times as wide or high.
hal::Picture straighten(const hal::Picture& picture, const LensMap& lens, Raster& raster);
inline constexpr double kLargestStretch = 2.0;

/// Figure 12 (b): radial distortion and perspective corrected: the floor to scale, x to the right, y up, `margin_m`
/// around the field and its goals. The raster is in meters, its rows run against y. kFull: the picture would be larger
/// than kLargestSide_px.
Status rectify_floor(const hal::Picture& picture, const CameraModel& camera, const FieldParameters& field,
                     double margin_m, double scale_px_per_m, hal::Picture& out, Raster& raster);
inline constexpr std::uint32_t kLargestSide_px = 8192;

/// Lines a `spacing_m` apart through the field's center, and the field's outline, over the pictures above.
void draw_grid(const CameraModel& camera, const LensMap& lens, const FieldParameters& field, double spacing_m,
               const Raster& raster, hal::Picture& straight);
void draw_grid(const FieldParameters& field, double spacing_m, const Raster& raster, hal::Picture& floor);

}  // namespace touchline::rectify
