#pragma once

#include <optional>
#include <string>
#include <vector>

#include "hal/result.h"
#include "tools/programs/calibrate/field/border_search.h"
#include "tools/programs/calibrate/field/field_drawing.h"
#include "tools/programs/calibrate/field/field_refinement.h"
#include "tools/programs/calibrate/field/vanishing_points.h"

namespace touchline::calibrate {

enum class HeightSource : std::uint8_t { kSeen, kMeasured, kRules };

/// Results of `touchline-calibrate field`.
struct FieldReport {
  std::optional<BorderSearch> border;  // empty if corners or points were given
  std::optional<VanishingPointModel> steps;
  ResidualSummary steps_mm;  // residual of the paper's model without refinement, at the points found
  FieldFit fit;
  std::vector<FloorPoint> points;  // given points, corners included
  RefinementReport refinement;     // points is 0 if the fit was not refined
  std::string unrefined;           // reason why there was no refinement
  std::vector<Mark> marks;
  HeightSource height = HeightSource::kSeen;
  std::vector<std::string> doubts;  // reasons to doubt the result that do not refute it
  double seconds = 0;
};

/// k1 of a wide-angle lens, used to estimate the effect of an unknown distortion.
inline constexpr double kWideLensK1 = -0.2;

/// Returns the error, in meters, of floor points between these points if the camera model has no distortion but the
/// lens has kWideLensK1.
double distortion_effect_m(const CameraParameters& camera, const std::vector<FloorPoint>& points);

/// Formats the residual of the model in use as one line.
std::string residual_text(const FieldReport& report);
/// Formats the report for a terminal; each line ends with a newline.
std::string text_of(const FieldReport& report);
/// Writes the report as JSON with units in the keys. kIo, kPermission: errors of the file.
Result<void> write_json(const FieldReport& report, const std::string& path);

}  // namespace touchline::calibrate
