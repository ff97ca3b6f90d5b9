#pragma once

#include <string>
#include <vector>

#include "tools/programs/calibrate/colors/clicks.h"
#include "tools/programs/calibrate/colors/color_assignment.h"

namespace touchline::calibrate {

/// Reason why a color that was detected without clicks is not certain.
struct DetectionDoubt {
  std::string text;  // one sentence: the reason, and what to show or to click on instead
  // The click as an option of touchline-calibrate ("--click red,U,V"); empty if no click would help.
  std::string option;
  std::size_t color = kNone;  // color that is not certain; kNone: the doubt concerns the whole result
};

/// Returns the doubts about detected colors; empty if a person only has to confirm them. `images`: indexed by
/// AssignmentInput::picture. Points that the person has clicked (`clicks`) are not advised again.
std::vector<DetectionDoubt> detection_doubts(const AssignmentInput& input, const Assignment& assignment,
                                             const std::vector<std::string>& images, const std::vector<Click>& clicks);

/// Lists robots that look like none in the team file, with their positions, if they are too few to raise a doubt.
/// Empty: none.
std::string describe_unlisted(const AssignmentInput& input, const Assignment& assignment,
                              const std::vector<std::string>& images);

}  // namespace touchline::calibrate
