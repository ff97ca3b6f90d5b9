#include "tests/region/tile_recipe.h"

#include <cstdio>

#include "tests/region/patterns.h"

namespace touchline::testing {

std::string text_of(const TileRecipe& recipe) {
  char numbers[160];
  std::snprintf(numbers, sizeof numbers, "%dx%d scale %dx%d shift %d noise %d runs %d seed %u cells ", recipe.width,
                recipe.height, recipe.scale_u, recipe.scale_v, recipe.shift, recipe.noise_per_mille, recipe.runs,
                recipe.seed);
  return numbers + recipe.cells;
}

std::optional<TileRecipe> recipe_of(const std::string& text) {
  TileRecipe recipe;
  char cells[1025] = "";
  if (std::sscanf(text.c_str(), "%dx%d scale %dx%d shift %d noise %d runs %d seed %u cells %1024s", &recipe.width,
                  &recipe.height, &recipe.scale_u, &recipe.scale_v, &recipe.shift, &recipe.noise_per_mille,
                  &recipe.runs, &recipe.seed, cells) != 9) {
    return {};
  }
  recipe.cells = cells;
  const bool sizes =
      recipe.width > 0 && recipe.height > 0 && recipe.scale_u > 0 && recipe.scale_v > 0 && recipe.shift >= 0 &&
      recipe.runs > 0 &&
      recipe.cells.size() == static_cast<std::size_t>(recipe.width) * static_cast<std::size_t>(recipe.height);
  const bool colors = recipe.cells.find_first_not_of("012345") == std::string::npos;
  return sizes && colors ? std::optional(recipe) : std::nullopt;
}

ColorGrid make_tiles(const TileRecipe& recipe, int width, int height) {
  std::mt19937 random(recipe.seed);
  ColorGrid grid = make_grid(width, height);
  for (int v = 0; v < height; ++v) {
    const int row = v / recipe.scale_v, tile_row = row % recipe.height;
    const int shift = row / recipe.height * recipe.shift;
    for (int u = 0; u < width; ++u) {
      const int column = (u + shift) / recipe.scale_u % recipe.width;
      grid.at(u, v) =
          static_cast<ColorId>(recipe.cells[static_cast<std::size_t>(tile_row * recipe.width + column)] - '0');
    }
    for (int u = 0; u < width && recipe.noise_per_mille > 0; u += recipe.runs) {
      if (pick(random, 0, 999) >= recipe.noise_per_mille) continue;
      const auto color = static_cast<ColorId>(pick(random, 0, kPaletteColors));
      for (int k = u; k < std::min(width, u + recipe.runs); ++k) grid.at(k, v) = color;
    }
  }
  return grid;
}

}  // namespace touchline::testing
