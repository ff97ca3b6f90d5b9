#pragma once

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "core/light/light_map.h"
#include "core/region/region_scanner.h"
#include "hal/result.h"
#include "tools/programs/calibrate/colors/box_learning.h"
#include "tools/programs/calibrate/colors/clicks.h"
#include "tools/programs/calibrate/colors/color_advice.h"
#include "tools/programs/calibrate/colors/region_growing.h"
#include "tools/programs/calibrate/imaging/camera_picture.h"

namespace touchline::calibrate {

struct ColorFitInput {
  std::vector<Click> clicks;
  std::map<std::string, CameraPicture> pictures;  // by Click::image; all have the same format and size
  std::vector<std::string> learned_from;          // pictures to learn from; empty: all
  std::map<std::string, std::vector<std::size_t>>
      // By picture: pixels that are neither sample nor background.
      unclear;
  std::map<std::string, std::vector<std::size_t>> things;  // by picture: pixels of `unclear` that belong to no robot
  std::map<std::string, ColorUse> uses;                    // uses of colors; the default is kOther
  LightMap light;
  Polygon region_of_interest;
  GrowthLimits growth;
  LearningRules rules;

  [[nodiscard]] bool learns_from(const std::string& image) const {
    return learned_from.empty() || std::find(learned_from.begin(), learned_from.end(), image) != learned_from.end();
  }
};

/// Result of a click.
struct ClickResult {
  std::size_t area_px = 0;  // 0: no patch was selected, see `reason`
  double recognized = 0;    // share of the pixels that are classified correctly
  std::string reason;
};

/// A region of a learned color away from all clicks: a patch without a click, or clutter.
struct StrayRegion {
  std::string image;
  std::size_t color = 0;
  PixelPoint center;
  std::uint32_t area_px = 0;
};

struct ColorFit {
  std::vector<std::string> names;  // ColorId is the index + 1; in the order of their first click
  std::vector<Channels> shown_rgb;
  std::vector<Channels> typical;  // for each color, median of its pixels, corrected by the light map
  TypicalBackground background;   // median of the background; empty if there is no background pixel
  ColorSpace space = ColorSpace::kRgb;
  LearnedColors learned;
  ColorAdvice advice;
  std::vector<ClickResult> clicks;  // in the order of the input
  // Confusion matrix of the pipeline's classifier, as shares of a row's pixels. Rows: the color clicked on. Columns:
  // background, then the colors.
  std::vector<std::vector<double>> confusion;
  // For each color, share of the background pixels that are classified as this color.
  std::vector<double> background_share;
  std::vector<StrayRegion> strays;  // regions at least half as large as a patch of their color
};

/// Learns colors from clicks: selects a patch around each click, takes everything else as background, learns boxes, and
/// classifies the pictures with the scanner of the pipeline to measure the quality. Regions of a learned color with the
/// size of a patch but without a click do not count as background; they are reported. Clicks without a patch are
/// reported and ignored. kNotFound: a color has no usable click. kInconsistent: pictures differ in size or format.
/// Otherwise as learn_boxes().
Result<ColorFit> fit_colors(const ColorFitInput& input);

/// Draws the classified picture: classified pixels in the color of their class, all others dimmed.
std::vector<std::uint8_t> preview_rgb(const ColorFitInput& input, const ColorFit& fit, const CameraPicture& picture);

}  // namespace touchline::calibrate
