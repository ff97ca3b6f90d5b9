#pragma once

#include <string>
#include <vector>

#include "tools/programs/calibrate/colors/color_assignment.h"

namespace touchline::calibrate {

/// Returns why colors that were detected without clicks are not certain, one sentence for each reason, and what to show
/// or to click on instead. Empty if a person only has to confirm them. `images`: AssignmentInput::picture is an index
/// into these.
std::vector<std::string> detection_doubts(const AssignmentInput& input, const Assignment& assignment,
                                          const std::vector<std::string>& images);

}  // namespace touchline::calibrate
