#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "hal/result.h"
#include "tools/programs/calibrate/colors/click_matching.h"
#include "tools/programs/calibrate/colors/clicks.h"
#include "tools/programs/calibrate/colors/color_assignment.h"
#include "tools/programs/calibrate/colors/detection_doubts.h"
#include "tools/programs/calibrate/colors/patch_extent.h"
#include "tools/programs/calibrate/colors/team_colors.h"
#include "tools/programs/calibrate/imaging/camera_picture.h"
#include "tools/programs/calibrate/venue/venue_draft.h"

namespace touchline::calibrate {

/// Colors that were detected without clicks.
struct DetectedColors {
  AssignmentInput input;
  Assignment assignment;
  std::vector<std::string> images;  // indexed by AssignmentInput::picture
  std::vector<Click> clicks;        // a click on each patch to learn from
  std::vector<ClickUse> uses;       // for each click of a person
  // Pixels, by picture, that are neither sample nor background: patches that nothing is learned from, and areas where
  // other patches of an incompletely detected robot must be.
  std::map<std::string, std::vector<std::size_t>> unclear;
  // Pixels of `unclear`, by picture, that look like a team's color although all robots of this team are recognized
  // elsewhere.
  std::map<std::string, std::vector<std::size_t>> things;
  std::string unlisted;                // text of describe_unlisted()
  std::array<PatchScale, 2> scales{};  // result of patch_scales(), indexed by Team
  std::vector<DetectionDoubt> doubts;  // reasons why the result is uncertain; if empty, a person only has to confirm it
};

/// Detects which patches have which color: finds patches (find_patches) and markers among them (find_markers), then
/// assigns colors (assign_colors). A click names the patch under it, and thereby the cluster of this patch; it adds to
/// the detection without clicks. If fewer robots are recognized with the clicks than without, the clicks that cause
/// this are left out. Needs camera model and field of the venue; uses its light map and region of interest. kNotFound:
/// the venue has no camera model. kInconsistent: pictures have different sizes. Also errors of Shading::build() and
/// CameraModel::configure().
Result<DetectedColors> auto_detect_colors(const VenueDraft& venue, const TeamColors& team,
                                          const std::vector<Click>& clicks,
                                          const std::map<std::string, CameraPicture>& pictures);

/// Writes the picture for the person who confirms the result: a frame with the color's name around each patch of a
/// color, and a gray frame around other patches.
Result<void> write_detection_picture(const std::string& path, const DetectedColors& found, const std::string& image,
                                     const CameraPicture& picture);

}  // namespace touchline::calibrate
