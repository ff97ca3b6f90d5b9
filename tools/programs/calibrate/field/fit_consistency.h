#pragma once

#include <optional>
#include <string>
#include <vector>

#include "hal/result.h"
#include "tools/programs/calibrate/field/edge_search.h"
#include "tools/programs/calibrate/field/field_fit.h"
#include "tools/programs/calibrate/field/field_report.h"

// Compares what a person said about the field (height of the camera, size, drawing) with what the picture shows. What
// the picture contradicts is refused; what only usual lenses or the rules of a league contradict is a doubt.
namespace touchline::calibrate {

// Chi-square (one degree of freedom) of a given height: five standard deviations refuse, three are a doubt. Standard
// deviations of the picture's own height are up to 2.5 times too small for lenses that the model does not describe
// (test FieldRefinement.EstimatesTheUncertaintyOfTheHeight).
inline constexpr double kImpossibleHeight = 25.0, kDoubtfulHeight = 9.0;
// Beyond this share, the picture does not show the height: usual lenses alone determine it to a third.
inline constexpr double kShownHeight = 0.15;

bool shows_height(const HeightEvidence& evidence);
/// The picture contradicts the given height.
bool contradicts(const HeightEvidence& evidence);

/// Says what the picture alone tells about the height: "the picture alone says 1.97 m (+- 0.06)", or that it cannot.
std::string describe(const HeightEvidence& evidence);

/// What the figures of the camera above the floor assume: " if the height is right"; empty if the picture shows them.
std::string assumption_of(const FieldReport& report);

/// Doubts about a given height: what the picture, usual lenses and `rules` of the league say against it.
std::vector<std::string> height_doubts(const FieldReport& report, const std::optional<HeightPrior>& rules,
                                       int width_px);

/// Looks for the lines and circles around the center of the field beside their drawing, and for the center line along
/// the field. kOutOfRange: one of them is seen there, so border, size or drawing are wrong. A marking that is not
/// seen at all says nothing. `tolerance_m`: what the camera model may be off in the middle of the field.
Result<void> check_center_markings(const LightPicture& picture, const FieldReport& report, double tolerance_m);

// A center circle that lies farther beside its drawing means that the border is wrong by about two centimeters, since
// it has a quarter of the field's size. Paint is laid more exactly.
inline constexpr double kMaxMarkingOffset_m = 0.005;

}  // namespace touchline::calibrate
