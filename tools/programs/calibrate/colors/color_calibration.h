#pragma once

#include <string>
#include <vector>

#include "hal/result.h"
#include "tools/programs/calibrate/colors/auto_detect.h"
#include "tools/programs/calibrate/colors/color_fit.h"
#include "tools/programs/calibrate/colors/self_check.h"
#include "tools/programs/calibrate/venue/venue_draft.h"

// The way from pictures to the sections of the venue file, for touchline-calibrate colors and for touchline-setup.
namespace touchline::calibrate {

/// What colors are learned for. The paths are those of the files that were read.
struct ColorFiles {
  std::string venue, team;
  VenueDraft draft;
  TeamColors colors;
};

/// Detects colors (auto_detect_colors) with the clicks of `input`. If a self-check with the colors that follow does not
/// pass, and one without any click recognizes more (or as much, and passes), the clicks are added one by one, and those
/// that make the self-check worse are left out: a click can only improve the result. Without clicks, each of up to four
/// pictures is also tried alone, and learned from if a self-check in all of them recognizes more
/// (DetectedColors::images). Errors of auto_detect_colors().
Result<DetectedColors> detect_with_clicks(const ColorFiles& files, const ColorFitInput& input);

/// Copies the venue file and replaces these sections of the copy, which is to be in the folder of the venue file,
/// because the venue file names others relative to it. kIo: the copy cannot be written. Errors of write_sections().
Result<void> write_copy(const std::string& venue, const std::vector<Section>& sections, const std::string& copy);

/// Says that colors are not learned from all pictures; empty if they are.
std::string describe_left_out(const DetectedColors& found, const ColorFitInput& input);

/// Replaces the clicks of `input` by the patches that were detected with their help, and returns the robots and
/// balls in the pictures. kInconsistent: the detection has doubts; the message lists them.
Result<VisibleByPicture> take_detected(const DetectedColors& found, ColorFitInput& input);

/// Checks that each color of the team file has a click. kNotFound: names those without.
Result<void> check_all_colors(const std::string& team_path, const TeamColors& team, const std::vector<Click>& clicks);

/// A color whose patches cannot be what its name says; a white line that is called blue passes every other check.
struct OddColor {
  std::string name, looks;  // "blue", "white"
  Rgb rgb{};
};
/// The odd colors that are not in `accepted`.
std::vector<OddColor> find_odd_colors(const ColorFit& fit, const std::vector<std::string>& accepted);

/// [light] without the reference of the field, which belongs to former colors, [colors] and [[color]] of the venue
/// file, in this order.
std::vector<Section> color_sections(const VenueDraft& venue, const ColorFit& fit);

}  // namespace touchline::calibrate
