#pragma once

#include <vector>

#include "tools/programs/calibrate/colors/robot_inference.h"

namespace touchline::calibrate {

/// Takes patches of recognized robots from the ball, unless a person has clicked on them. Then finds the ball if
/// assign_colors() did not, because its shaded rim looks like another color: of the patches with about its size that
/// are not on a recognized robot, the one that looks most like the name of its color, covers most of the ball's disk
/// and is surrounded by most floor, if no other one is nearly as good. Only those of its pixels count that differ from
/// the floor and look more like the ball than like any color that is known. The pixels are added to `input` as a
/// sampled patch.
void infer_ball(AssignmentInput& input, const CameraModel& camera, const PatchSize& size,
                const std::vector<SearchedPicture>& pictures, Assignment& assignment);

}  // namespace touchline::calibrate
