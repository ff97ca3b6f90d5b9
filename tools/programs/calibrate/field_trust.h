#pragma once

#include <string>
#include <vector>

#include "core/geometry/camera_model.h"
#include "core/marker/matcher.h"
#include "core/status.h"
#include "tools/programs/calibrate/edge_search.h"
#include "tools/programs/calibrate/field_refinement.h"

// What makes a calibration one that robots may be driven by. Each answers false with the reason, and what to do.
namespace touchline::calibrate {

/// Enough of each of the border's sides was found. `looked_at`: points tried, one number a mark.
[[nodiscard]] bool trust_sides(const std::vector<Mark>& marks, const std::vector<std::size_t>& looked_at,
                               const std::vector<MarkPoint>& found, std::string& reason);
// Of each side; at a side that was not seen the lens would be extrapolated.
inline constexpr double kLeastSideShare = 0.4;

struct PictureSize {
  int width_px = 0, height_px = 0;
  double zoom = 1;  // pixels for one of a usual camera
};

/// The border lies in the picture, the drawing fits to a fraction of a pixel, and the camera that was found is one that
/// somebody could have hung up, its height known well enough to place a robot's top. kNotFound: too little was seen;
/// kInconsistent: what was seen contradicts the field's size or any camera, or leaves its height open.
Status trust_camera(const PictureSize& picture, const FieldParameters& field, const CameraModel& model,
                    const FieldFit& fit, const RefinementReport& report, std::string& reason);
inline constexpr double kMostOutside = 0.05;   // of the border
inline constexpr double kMostOutliers = 0.35;  // of the points
inline constexpr double kMostRms_px = 0.45;    // times zoom
inline constexpr double kMostStrain = 12.0;    // see CameraUncertainty
inline constexpr double kMostTop_mm = 14.0;    // standard deviation in the worst corner
inline constexpr double kMostFloor_mm = 5.0;   // likewise, on the floor

}  // namespace touchline::calibrate
