#pragma once

#include <string>
#include <vector>

#include "tools/programs/calibrate/colors/color_assignment.h"

namespace touchline::calibrate {

/// Why a color that was detected without clicks is not certain.
struct DetectionDoubt {
  std::string text;    // one sentence: the reason, and what to show or to click on instead
  std::string option;  // the click as an option of touchline-calibrate ("--click red,U,V"); empty if none would help
};

/// Returns the doubts about detected colors; empty if a person only has to confirm them. `images`:
/// AssignmentInput::picture is an index into these.
std::vector<DetectionDoubt> detection_doubts(const AssignmentInput& input, const Assignment& assignment,
                                             const std::vector<std::string>& images);

}  // namespace touchline::calibrate
