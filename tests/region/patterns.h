#pragma once

#include <array>
#include <random>

#include "core/region/region_scanner.h"
#include "tests/color/owned_picture.h"
#include "tests/region/literal_labeling.h"

// Pictures that are difficult to label, in every pixel format.
namespace touchline::testing {

enum class Pattern {
  kEmpty,
  kFull,
  kSalt,              // each pixel has a random color or background
  kPercolation,       // 59.3 % of one color: the threshold at which clusters span the picture
  kTwoColors,         // no background: different colors touch everywhere
  kCheckerboard,      // single pixels
  kWideCheckerboard,  // two by two
  kVerticalStripes,
  kHorizontalStripes,
  kCombUp,  // teeth that are joined only in the last row
  kCombDown,
  kNestedArches,
  kSpiral,
  kStairs,  // one-pixel steps, down to the left
  kBlobs,   // disks of all colors on background with specks, as on a field
  kFound,   // the slowest picture that touchline-bench --search has found
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

// Colors 1 to 5 differ only in channel 0, so each pixel can have its own color even if pixels share chroma.
constexpr int kPaletteColors = 5;
ColorBoxes palette();

ColorGrid make_pattern(Pattern pattern, int width, int height, std::mt19937& random);

/// Makes a picture whose colors by the palette are those of the grid. Channels that do not matter are random.
OwnedPicture paint(const ColorGrid& grid, PixelFormat format, int padding, std::mt19937& random);

/// Parameters for scanning such a picture.
ScanParameters parameters_for(const Frame& frame);

/// Returns the colors of a frame by definition: boxes, light levels, and the even-odd rule for the region of interest
/// (whose points must be multiples of half a pixel).
ColorGrid defined_colors(const Frame& frame, const ScanParameters& parameters);

}  // namespace touchline::testing
