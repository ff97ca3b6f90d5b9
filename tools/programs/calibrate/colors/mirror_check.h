#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "tools/programs/calibrate/colors/auto_detect.h"

namespace touchline::calibrate {

/// The layout as a mirror shows it: left and right exchanged.
MarkerLayout mirrored(const MarkerLayout& layout);

/// For colors with doubts, or robots that the team file does not list: looks for the mirror images of the layouts in
/// the same pictures. If they explain the robots and the layouts themselves do not, the picture is mirrored, and the
/// doubts about colors are beside the point. Layouts that are their own mirror images, or differ from them by a
/// rotation, as the paper's, cannot show it. Empty: no mirror was found, or nothing about `found` is doubtful.
std::optional<DetectionDoubt> mirror_doubt(const VenueDraft& venue, const TeamColors& team,
                                           const std::vector<Click>& clicks,
                                           const std::map<std::string, CameraPicture>& pictures,
                                           const DetectedColors& found);

}  // namespace touchline::calibrate
