#pragma once

#include <array>
#include <vector>

#include "core/geometry/camera_model.h"
#include "core/marker/matcher.h"
#include "hal/replay/picture.h"
#include "tools/programs/rectify/rectification.h"

namespace touchline::rectify {

/// How far the points of a side are from their common straight line.
struct Deviation {
  double rms_px = 0, rms_mm = 0, max_mm = 0;
};

/// One side of the field's border, as it was found in the picture.
struct SideStraightness {
  std::size_t points = 0, left_out = 0;  // left out: what stands before the border, goals, chamfers
  Deviation distorted, straightened, rectified;
};

/// A place of the border that was found in the picture.
struct BorderPoint {
  std::size_t side = 0;  // 0 to 3: -y, +x, +y, -x
  Point pixel{};
};

/// The border's sides looked for where `camera` has them, up to kReach_px beside; what is not on the side's straight
/// line once rectified by this camera is left out.
std::vector<BorderPoint> border_points(const hal::Picture& picture, const CameraModel& camera,
                                       const FieldParameters& field, std::array<std::size_t, 4>& left_out);
inline constexpr double kReach_px = 10.0;

/// Deviations of these points in the three pictures. Millimeters are those of the floor where the point lies.
/// `scale_px_per_m`: of the rectified picture.
std::array<SideStraightness, 4> straightness(const std::vector<BorderPoint>& points,
                                             const std::array<std::size_t, 4>& left_out, const CameraModel& camera,
                                             const LensMap& lens, double scale_px_per_m);

}  // namespace touchline::rectify
