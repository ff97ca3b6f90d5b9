#pragma once

#include <string>
#include <vector>

#include "hal/result.h"
#include "tools/programs/calibrate/colors/auto_detect.h"
#include "tools/programs/calibrate/colors/color_fit.h"
#include "tools/programs/calibrate/colors/self_check.h"
#include "tools/programs/calibrate/venue/venue_draft.h"

// The way from pictures to the sections of the venue file, for touchline-calibrate colors and for touchline-setup.
namespace touchline::calibrate {

/// Replaces the clicks of `input` by the patches that were detected with their help, and returns the robots in the
/// pictures. kInconsistent: the detection has doubts; the message lists them.
Result<VisibleRobots> take_detected(const DetectedColors& found, ColorFitInput& input);

/// Checks that each color of the team file has a click. kNotFound: names those without.
Result<void> check_all_colors(const std::string& team_path, const TeamColors& team, const std::vector<Click>& clicks);

/// A color whose patches cannot be what its name says; a white line that is called blue passes every other check.
struct OddColor {
  std::string name, looks;  // "blue", "white"
  Rgb rgb{};
};
/// The odd colors that are not in `accepted`.
std::vector<OddColor> find_odd_colors(const ColorFit& fit, const std::vector<std::string>& accepted);

/// [light] without the reference of the field, which belongs to former colors, [colors] and [[color]] of the venue
/// file, in this order.
std::vector<Section> color_sections(const VenueDraft& venue, const ColorFit& fit);

}  // namespace touchline::calibrate
