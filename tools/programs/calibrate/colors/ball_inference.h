#pragma once

#include <vector>

#include "tools/programs/calibrate/colors/robot_inference.h"

namespace touchline::calibrate {

/// Removes patches of recognized robots from the ball's patches, except those that a person has clicked on. Then finds
/// the ball if assign_colors() did not, because its shaded rim looks like another color. Candidates are patches with
/// about the ball's size that are not on a recognized robot. The chosen one looks most like the name of the ball's
/// color, covers most of the ball's disk and is surrounded by most floor; none is chosen if another is nearly as good.
/// A candidate's pixels count only if they differ from the floor and look more like the ball than like any known color.
/// The chosen pixels are added to `input` as a sampled patch.
void infer_ball(AssignmentInput& input, const CameraModel& camera, const PatchSize& size,
                const std::vector<SearchedPicture>& pictures, Assignment& assignment);

}  // namespace touchline::calibrate
