#pragma once

#include <vector>

#include "tools/programs/calibrate/colors/color_assignment.h"
#include "tools/programs/calibrate/colors/layout_sampling.h"

namespace touchline::calibrate {

/// A searched picture: its number in AssignmentInput::picture.
struct SearchedPicture {
  std::size_t number = 0;
  SampledPicture picture;
};

/// Returns the gain of each channel from the usual appearance of colors to their assigned patches: the geometric mean
/// over the colors whose usual appearance is bright in this channel, with a prior of 1.
Rgb light_gain(const AssignmentInput& input, const Assignment& assignment);

/// Recognizes robots of the team file that assign_colors() has not recognized because glare or shade changes their
/// colors. All patches of a robot are under one light. Each robot that is missing in a picture is therefore fitted to
/// each unused patch that can be its team patch, using the colors that are known already, one light factor for the
/// whole robot, and a glare for each patch. A robot is accepted if it explains the colors at the places of its patches,
/// each better than any other color does, and if no other missing robot explains them nearly as well. A color without a
/// patch is expected to look like its name. If only a robot in glare or shade shows a color, the color is learned as it
/// would look without the glare and in the light of other robots, which the robot's other patches reveal
/// (FoundPatch::usual). For this, no other color may explain the patch, and no other color may explain the other
/// patches much better; otherwise the robot is listed in Assignment::in_odd_light. Sampled patches are added to
/// `input`, and robots and patches to `assignment`.
void infer_robots(AssignmentInput& input, const CameraModel& camera, const std::vector<SearchedPicture>& pictures,
                  Assignment& assignment);

}  // namespace touchline::calibrate
