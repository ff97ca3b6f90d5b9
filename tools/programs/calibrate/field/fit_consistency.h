#pragma once

#include <optional>
#include <string>
#include <vector>

#include "hal/result.h"
#include "tools/programs/calibrate/field/edge_search.h"
#include "tools/programs/calibrate/field/field_fit.h"
#include "tools/programs/calibrate/field/field_report.h"

// Compares a person's entries about the field (height of the camera, size, drawing) with the picture. A value that the
// picture contradicts is rejected; a value that contradicts only usual lenses or the rules of a league raises a doubt.
namespace touchline::calibrate {

// Limits of the chi-square (one degree of freedom) of a given height: at five standard deviations it is rejected, at
// three it raises a doubt. The limits are wide because for lenses that the model does not describe, the computed
// standard deviation of the height is up to 2.5 times too small (test
// FieldRefinement.EstimatesTheUncertaintyOfTheHeight).
inline constexpr double kImpossibleHeight = 25.0, kDoubtfulHeight = 9.0;
// Relative standard deviation above which the picture counts as not showing the height; usual lenses alone determine it
// to a third.
inline constexpr double kShownHeight = 0.15;

bool shows_height(const HeightEvidence& evidence);
/// Returns whether the picture contradicts the given height.
bool contradicts(const HeightEvidence& evidence);

/// Describes the height that follows from the picture alone: "the picture alone says 1.97 m (+- 0.06)", or says that
/// none follows.
std::string describe(const HeightEvidence& evidence);

/// Names the assumption behind the figures above the floor: " if the height is right"; empty if the picture itself
/// shows the height.
std::string assumption_of(const FieldReport& report);

/// Returns the doubts about a given height, from the picture, usual lenses and `rules` of the league.
std::vector<std::string> height_doubts(const FieldReport& report, const std::optional<HeightPrior>& rules,
                                       int width_px);

/// Searches for the lines and circles around the center of the field near their drawing, and for the center line in the
/// direction along the field. kOutOfRange: a marking is seen beside its drawing, so border, size or drawing is wrong. A
/// marking that is not seen at all is no evidence. `tolerance_m`: possible error of the camera model in the middle of
/// the field.
Result<void> check_center_markings(const LightPicture& picture, const FieldReport& report, double tolerance_m);

// Largest offset of the center circle from its drawing. The circle has a quarter of the field's size, so a larger
// offset means that the border is wrong by about two centimeters. Paint is more accurate.
inline constexpr double kMaxMarkingOffset_m = 0.005;

}  // namespace touchline::calibrate
