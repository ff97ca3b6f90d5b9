#pragma once

#include <string>
#include <vector>

#include "hal/result.h"
#include "tools/programs/calibrate/colors/auto_detect.h"
#include "tools/programs/calibrate/colors/color_fit.h"
#include "tools/programs/calibrate/colors/self_check.h"
#include "tools/programs/calibrate/venue/venue_draft.h"

// Turns pictures into the sections of the venue file, for touchline-calibrate colors and touchline-setup.
namespace touchline::calibrate {

/// Files that color learning reads.
struct ColorFiles {
  std::string venue, team;
  VenueDraft draft;
  TeamColors colors;
};

/// Detects colors (auto_detect_colors) with the clicks of `input`. The clicks are added one by one if a self-check with
/// their colors does not pass, and a self-check without any click recognizes more (or as much, and passes). Clicks that
/// make the self-check worse are then left out, so a click can only improve the result. Without clicks, each of up to
/// four pictures is also tried alone; it is used alone if its colors recognize more in a self-check with all pictures
/// (DetectedColors::images). Errors of auto_detect_colors().
Result<DetectedColors> detect_with_clicks(const ColorFiles& files, const ColorFitInput& input);

/// Copies the venue file and replaces these sections in the copy. The copy must be in the folder of the venue file,
/// because the venue file names other files relative to this folder. kIo: the copy cannot be written. Errors of
/// write_sections().
Result<void> write_copy(const std::string& venue, const std::vector<Section>& sections, const std::string& copy);

/// Returns a text if colors are learned from some of the pictures only; empty otherwise.
std::string describe_left_out(const DetectedColors& found, const ColorFitInput& input);

/// Replaces the clicks of `input` by the patches that were detected with their help, and returns the robots and
/// balls in the pictures. kInconsistent: the detection has doubts; the message lists them.
Result<VisibleByPicture> take_detected(const DetectedColors& found, ColorFitInput& input);

/// Checks that each color of the team file has a click. kNotFound: some colors have none; the message names them.
Result<void> check_all_colors(const std::string& team_path, const TeamColors& team, const std::vector<Click>& clicks);

/// A color whose patches cannot have the color of its name; for example, a white line that is called blue passes every
/// other check.
struct OddColor {
  std::string name, looks;  // "blue", "white"
  Rgb rgb{};
};
/// Returns the odd colors that are not in `accepted`.
std::vector<OddColor> find_odd_colors(const ColorFit& fit, const std::vector<std::string>& accepted);

/// Returns [light] without the reference of the field (which belongs to the former colors), [colors] and [[color]] of
/// the venue file, in this order.
std::vector<Section> color_sections(const VenueDraft& venue, const ColorFit& fit);

}  // namespace touchline::calibrate
