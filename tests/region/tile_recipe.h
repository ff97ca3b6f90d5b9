#pragma once

#include <optional>
#include <string>

#include "tests/region/literal_labeling.h"

namespace touchline::testing {

/// Describes a picture in one line of text: a tile of colors is repeated, and random pixels are changed. The search for
/// slow pictures (touchline-bench --search) varies it.
struct TileRecipe {
  int width = 1, height = 1;     // size of the tile in cells
  int scale_u = 1, scale_v = 1;  // size of a cell in pixels
  int shift = 0;                 // columns by which each repetition is shifted to the right
  int noise_per_mille = 0;       // share of pixels with a random color or background
  int runs = 1;                  // length of the random runs
  unsigned seed = 1;
  std::string cells = "0";  // colors, row by row; '0' is background
};

/// Returns "8x4 scale 1x2 shift 3 noise 120 runs 2 seed 7 cells 0120...".
std::string text_of(const TileRecipe& recipe);
std::optional<TileRecipe> recipe_of(const std::string& text);

/// Makes a picture with colors 0 to kPaletteColors.
ColorGrid make_tiles(const TileRecipe& recipe, int width, int height);

}  // namespace touchline::testing
