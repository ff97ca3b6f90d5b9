#pragma once

#include <array>
#include <random>

#include "core/region/region_scanner.h"
#include "tests/color/owned_picture.h"
#include "tests/region/literal_labeling.h"

// Pictures that labeling finds hard, and their painting in every pixel format.
namespace touchline::testing {

enum class Pattern {
  kEmpty,
  kFull,
  kSalt,              // every pixel any color or background
  kPercolation,       // 59.3 % of one color: the threshold at which clusters span the picture
  kTwoColors,         // no background, colors touch everywhere
  kCheckerboard,      // single pixels
  kWideCheckerboard,  // two by two
  kVerticalStripes,
  kHorizontalStripes,
  kCombUp,  // teeth joined below: components meet in the last row only
  kCombDown,
  kNestedArches,
  kSpiral,
  kStairs,  // one-pixel steps, down to the left
  kBlobs,   // disks of all colors on background with specks: what a field looks like
  kFound,   // the slowest that touchline-bench --search has come upon
};
inline constexpr std::array kAllPatterns = {Pattern::kEmpty,
                                            Pattern::kFull,
                                            Pattern::kSalt,
                                            Pattern::kPercolation,
                                            Pattern::kTwoColors,
                                            Pattern::kCheckerboard,
                                            Pattern::kWideCheckerboard,
                                            Pattern::kVerticalStripes,
                                            Pattern::kHorizontalStripes,
                                            Pattern::kCombUp,
                                            Pattern::kCombDown,
                                            Pattern::kNestedArches,
                                            Pattern::kSpiral,
                                            Pattern::kStairs,
                                            Pattern::kBlobs,
                                            Pattern::kFound};
const char* name_of(Pattern pattern);

// Colors 1 to 5 are told apart by channel 0 alone, so that even formats with shared chroma can give each pixel its own.
constexpr int kPaletteColors = 5;
ColorBoxes palette();

ColorGrid make_pattern(Pattern pattern, int width, int height, std::mt19937& random);

/// A picture that the palette reads as the grid; channels that do not matter are random.
OwnedPicture paint(const ColorGrid& grid, PixelFormat format, int padding, std::mt19937& random);

/// The parameters of a scan of such a picture.
ScanParameters parameters_for(const Frame& frame);

/// The colors of a frame by the definition: boxes, light levels, and the even-odd rule for the region of interest
/// (whose points must be multiples of half a pixel).
ColorGrid defined_colors(const Frame& frame, const ScanParameters& parameters);

}  // namespace touchline::testing
