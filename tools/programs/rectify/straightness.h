#pragma once

#include <array>
#include <vector>

#include "core/geometry/camera_model.h"
#include "core/marker/matcher.h"
#include "hal/replay/picture.h"
#include "tools/programs/rectify/rectification.h"

namespace touchline::rectify {

/// Deviation of the points of one side from their common straight line.
struct Deviation {
  double rms_px = 0, rms_mm = 0, max_mm = 0;
};

/// One side of the border as found in the picture.
struct SideStraightness {
  std::size_t points = 0, left_out = 0;  // left out: points on objects in front of the border, goals, chamfers
  Deviation distorted, straightened, rectified;
};

/// A point of the border found in the picture.
struct BorderPoint {
  std::size_t side = 0;  // 0 to 3: -y, +x, +y, -x
  Point pixel{};
};

/// Searches for the sides of the border up to kReach_px from where `camera` projects them. Points that are not on the
/// straight line of their side after rectification are dropped.
std::vector<BorderPoint> border_points(const hal::Picture& picture, const CameraModel& camera,
                                       const FieldParameters& field, std::array<std::size_t, 4>& left_out);
inline constexpr double kReach_px = 10.0;

/// Computes the deviations of these points in the three pictures. Deviations in millimeters are measured on the floor
/// at the point. `scale_px_per_m`: scale of the rectified picture.
std::array<SideStraightness, 4> straightness(const std::vector<BorderPoint>& points,
                                             const std::array<std::size_t, 4>& left_out, const CameraModel& camera,
                                             const LensMap& lens, double scale_px_per_m);

}  // namespace touchline::rectify
