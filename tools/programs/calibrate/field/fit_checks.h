#pragma once

#include <string>
#include <vector>

#include "core/geometry/camera_model.h"
#include "core/marker/matcher.h"
#include "hal/result.h"
#include "tools/programs/calibrate/field/edge_search.h"
#include "tools/programs/calibrate/field/field_refinement.h"

// Checks whether a calibration is good enough to drive robots. Each error gives the reason and what to do.
namespace touchline::calibrate {

/// Checks that enough of each side of the border was found. `tried_points`: points tried per mark.
Result<void> check_sides(const std::vector<Mark>& marks, const std::vector<std::size_t>& tried_points,
                         const std::vector<MarkPoint>& found);
// Least share of each side that must be found, because the lens model is extrapolated where a side is invisible.
inline constexpr double kMinSideShare = 0.4;

struct PictureSize {
  int width_px = 0, height_px = 0;
  double zoom = 1;  // picture width relative to a usual camera's
};

/// Checks that the border lies in the picture, that the drawing fits to a fraction of a pixel, that the camera model is
/// plausible, and that its height is known well enough to locate the top of a robot. kNotFound: too little is visible.
/// kInconsistent: the picture contradicts the size of the field or any plausible camera, or the height is uncertain.
Result<void> check_camera(const PictureSize& picture, const FieldParameters& field, const CameraModel& model,
                          const FieldFit& fit, const RefinementReport& report);
inline constexpr double kMaxOutsideShare = 0.05;   // share of the border that may lie outside the picture
inline constexpr double kMaxOutlierShare = 0.35;   // share of the points that may be outliers
inline constexpr double kMaxRms_px = 0.45;         // multiplied by zoom
inline constexpr double kMaxLensChiSquare = 12.0;  // as in CameraUncertainty
inline constexpr double kMaxTopSigma_mm = 14.0;    // standard deviation in the worst corner
inline constexpr double kMaxFloorSigma_mm = 5.0;   // standard deviation in the worst corner, on the floor

}  // namespace touchline::calibrate
