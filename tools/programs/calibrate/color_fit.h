#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/light/light_map.h"
#include "core/region/region_scanner.h"
#include "core/status.h"
#include "tools/programs/calibrate/box_learning.h"
#include "tools/programs/calibrate/camera_picture.h"
#include "tools/programs/calibrate/click_growth.h"
#include "tools/programs/calibrate/clicks.h"
#include "tools/programs/calibrate/color_advice.h"

namespace touchline::calibrate {

struct ColorFitInput {
  std::vector<Click> clicks;
  std::map<std::string, CameraPicture> pictures;  // by Click::image; all of one format and size
  std::map<std::string, std::vector<std::size_t>>
      unclear;  // pixels of a picture that are neither sample nor background
  LightMap light;
  Polygon region_of_interest;
  GrowthLimits growth;
  LearningRules rules;
};

/// What came of a click.
struct ClickResult {
  std::size_t area_px = 0;  // 0: nothing was caught, `reason` says why
  double recognized = 0;    // share of its pixels that the boxes give the right color
  std::string reason;
};

/// A region of a color that was not learned from: a patch that was left out, or clutter that looks like one.
struct StrayRegion {
  std::string image;
  std::size_t color = 0;
  PixelPoint center;
  std::uint32_t area_px = 0;
};

struct ColorFit {
  std::vector<std::string> names;  // ColorId is the index + 1; in the order of their first click
  std::vector<Channels> shown_rgb;
  std::vector<Channels> typical;  // median of its patches' pixels, corrected by the light map
  TypicalBackground background;   // likewise of all else; none: there is no pixel of it
  ColorSpace space = ColorSpace::kRgb;
  LearnedColors learned;
  ColorAdvice advice;
  std::vector<ClickResult> clicks;  // as in the input
  // Rows: the color clicked on. Columns: background, then the colors. Shares of the row's pixels, classified by the
  // pipeline's scanner.
  std::vector<std::vector<double>> confusion;
  std::vector<double> background_share;  // a color: share of the background pixels that it takes
  std::vector<StrayRegion> strays;       // at least half as large as the usual patch of their color
};

/// Grows a patch around every click, takes all else as background, learns boxes, and classifies the pictures with the
/// pipeline's own scanner to say how good they are. A look-alike of a color away from all clicks (a patch that was not
/// clicked on, of a patch's size) does not count as background; it is reported. Clicks that catch nothing are reported
/// and left out. kNotFound: a color without a single good click; kInconsistent: pictures that differ in size or format;
/// else as learn_boxes().
Status fit_colors(const ColorFitInput& input, ColorFit& out, std::string& reason);

/// The picture as the pipeline sees it: pixels of a class in its color, all else dimmed.
std::vector<std::uint8_t> preview_rgb(const ColorFitInput& input, const ColorFit& fit, const CameraPicture& picture);

}  // namespace touchline::calibrate
