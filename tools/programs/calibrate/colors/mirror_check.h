#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "tools/programs/calibrate/colors/auto_detect.h"

namespace touchline::calibrate {

/// Returns the layout with left and right exchanged, as a mirror shows it.
MarkerLayout mirrored(const MarkerLayout& layout);

/// Searches for the mirror images of the layouts in the same pictures, if colors are in doubt or if robots were found
/// that are not in the team file. If these explain the robots and the layouts themselves do not, the picture is
/// mirrored, and the doubts about colors do not matter. A layout that equals its mirror image, at least after a
/// rotation, as the paper's does, cannot show that a picture is mirrored. Returns nothing if no mirror was found, or
/// nothing about `found` is doubtful.
std::optional<DetectionDoubt> mirror_doubt(const VenueDraft& venue, const TeamColors& team,
                                           const std::vector<Click>& clicks,
                                           const std::map<std::string, CameraPicture>& pictures,
                                           const DetectedColors& found);

}  // namespace touchline::calibrate
