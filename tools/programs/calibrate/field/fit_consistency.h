#pragma once

#include <optional>
#include <string>
#include <vector>

#include "hal/result.h"
#include "tools/programs/calibrate/field/edge_search.h"
#include "tools/programs/calibrate/field/field_fit.h"
#include "tools/programs/calibrate/field/field_report.h"

// Compares what a person said about the field (height of the camera, size, drawing) with the picture. A value that the
// picture contradicts is refused; a value that only usual lenses or the rules of a league contradict raises a doubt.
namespace touchline::calibrate {

// Chi-square (one degree of freedom) of a given height: at five standard deviations it is refused, at three it raises a
// doubt. Standard deviations of the height that the picture shows are up to 2.5 times too small for lenses that the
// model does not describe (test FieldRefinement.EstimatesTheUncertaintyOfTheHeight).
inline constexpr double kImpossibleHeight = 25.0, kDoubtfulHeight = 9.0;
// Relative standard deviation above which the picture does not show the height: usual lenses alone determine it to a
// third.
inline constexpr double kShownHeight = 0.15;

bool shows_height(const HeightEvidence& evidence);
/// Whether the picture contradicts the given height.
bool contradicts(const HeightEvidence& evidence);

/// Says what the picture alone tells about the height: "the picture alone says 1.97 m (+- 0.06)", or that it cannot.
std::string describe(const HeightEvidence& evidence);

/// Names the assumption behind the figures of the camera above the floor: " if the height is right"; empty if the
/// picture shows them.
std::string assumption_of(const FieldReport& report);

/// Returns the doubts about a given height: what the picture, usual lenses and `rules` of the league say against it.
std::vector<std::string> height_doubts(const FieldReport& report, const std::optional<HeightPrior>& rules,
                                       int width_px);

/// Looks for the lines and circles around the center of the field beside their drawing, and for the center line along
/// the field. kOutOfRange: a marking is seen beside its drawing, so border, size or drawing are wrong. A marking that
/// is not seen at all is no evidence. `tolerance_m`: possible error of the camera model in the middle of the field.
Result<void> check_center_markings(const LightPicture& picture, const FieldReport& report, double tolerance_m);

// Greatest offset of the center circle from its drawing. A larger offset means that the border is wrong by about two
// centimeters, because the circle has a quarter of the field's size. Paint is laid more exactly.
inline constexpr double kMaxMarkingOffset_m = 0.005;

}  // namespace touchline::calibrate
