#pragma once

#include <optional>
#include <string>
#include <vector>

#include "hal/result.h"
#include "tools/programs/calibrate/colors/clicks.h"
#include "tools/programs/setup/job.h"

namespace touchline::setup {

/// A person's entries in the step "colors". Clicks of earlier steps are in the draft.
struct ColorRequest {
  std::optional<calibrate::Click> click;  // click to add; its image is named by color_image()
  std::optional<std::size_t> removed_click;
  std::vector<std::string> odd_colors;  // colors that need not look like their names
};

/// Returns the name of a picture of the step, counted from 0.
std::string color_image(std::size_t number);

/// Shows the newest of the pictures of robots and ball. Errors of the encoder.
Result<void> show_color_picture(const JobInput& input, const JobOutput& output);

/// Learns the colors from the pictures and clicks, checks them with the pipeline, and writes them to the venue file. If
/// the assignment of colors to patches is uncertain, the file stays unchanged, and the notes say why. kNotFound: there
/// is no picture. Errors of read_draft(), read_team_colors(), auto_detect_colors(), fit_colors() and self_check().
Result<void> learn_colors(const ColorRequest& request, const JobInput& input, const JobOutput& output);

}  // namespace touchline::setup
