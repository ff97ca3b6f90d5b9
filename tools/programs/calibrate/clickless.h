#pragma once

#include <map>
#include <string>
#include <vector>

#include "tools/programs/calibrate/camera_picture.h"
#include "tools/programs/calibrate/clicks.h"
#include "tools/programs/calibrate/color_assignment.h"
#include "tools/programs/calibrate/team_colors.h"
#include "tools/programs/calibrate/venue_draft.h"

namespace touchline::calibrate {

/// Colors found without a click.
struct FoundColors {
  AssignmentInput input;
  Assignment assignment;
  std::vector<std::string> images;  // AssignmentInput::picture counts these
  std::vector<Click> clicks;        // what a person would have clicked on; without the colors that were clicked
  // Pixels of patches that are not learned from, and where a robot's other patches must be that were not found: no
  // background either.
  std::map<std::string, std::vector<std::size_t>> unclear;
  std::vector<std::string> doubts;  // why it is not to be trusted; empty: it is, once a person has looked at it
};

/// Finds patches in the pictures (find_patches), markers among them (find_markers) and which color is which
/// (assign_colors). Colors that `clicks` name keep the look that was clicked on. Needs the venue's camera model and
/// field; uses its light map and region of interest. kNotFound: the venue has no camera model; kInconsistent: pictures
/// of other sizes than the first; errors of Shading::build() and CameraModel::configure().
Status find_colors(const VenueDraft& venue, const TeamColors& team, const std::vector<Click>& clicks,
                   const std::map<std::string, CameraPicture>& pictures, FoundColors& out, std::string& reason);

/// The picture with every patch of a color framed and named, others framed in grey: for the person who confirms.
Status write_found(const std::string& path, const FoundColors& found, const std::string& image,
                   const CameraPicture& picture, std::string& reason);

}  // namespace touchline::calibrate
