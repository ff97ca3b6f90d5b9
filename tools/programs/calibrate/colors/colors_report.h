#pragma once

#include <vector>

#include "tools/programs/calibrate/colors/auto_detect.h"
#include "tools/programs/calibrate/colors/color_fit.h"

// The report of touchline-calibrate colors, on standard output.
namespace touchline::calibrate {

/// Prints which patches have which color, for the person who confirms it.
void print_detected(const DetectedColors& found);

/// Prints every click that was not used, with the reason.
void print_unused(const std::vector<Click>& clicks, const std::vector<ClickUse>& uses);

/// Prints how well the learned boxes classify the pictures that they were learned from.
void print_report(const ColorFitInput& input, const ColorFit& fit);

}  // namespace touchline::calibrate
