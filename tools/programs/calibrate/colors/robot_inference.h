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

/// Gain of each channel from the usual look of the colors to that of the patches assigned to them: the geometric mean
/// over the colors whose usual look is bright in this channel, with a prior of 1.
Rgb light_gain(const AssignmentInput& input, const Assignment& assignment);

/// Recognizes robots of the team file that assign_colors() has not recognized because glare or shade changes their
/// colors. All patches of a robot are under one light: with the colors that are known already, each robot that is
/// missing in a picture is fitted to each unused patch that can be its team patch, with a factor for the whole
/// robot and a glare for each patch. A robot is accepted if it explains the colors at the places of its patches, each
/// of them better than any other color does, and if no other missing robot explains them nearly as well. A color
/// without a patch is expected to look like its name. If a robot in glare or shade alone shows a color, the color is
/// learned as it would be without the glare and in the light of other robots, as the robot's other patches show these
/// (FoundPatch::usual). No other color may explain that patch, and none the other patches much better; else, the robot
/// is listed in Assignment::in_odd_light. Sampled patches are added to `input`, robots and patches to `assignment`.
void infer_robots(AssignmentInput& input, const CameraModel& camera, const std::vector<SearchedPicture>& pictures,
                  Assignment& assignment);

}  // namespace touchline::calibrate
