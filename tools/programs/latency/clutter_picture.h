#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/pipeline.h"

namespace touchline::latency {

/// Describes, in a few numbers, a picture for which the whole step is slow: robots of the venue's teams, which may
/// overlap; a heap of patches; spots of the ball's color; noise; and blur over everything.
struct ClutterRecipe {
  int robots = 0;             // number of robots, alternately of both teams
  int spacing_percent = 150;  // spacing of the robots' grid, relative to their side
  int covered_percent = 0;    // share of robots with a black bar across their top
  int heap = 0;               // number of patches in the heap
  int patch_percent = 100;    // size of these patches relative to a team patch
  int aspect_percent = 100;   // width / length of these patches
  int spread_percent = 100;   // share of the picture's width and height that the heap takes
  int colors = 13;            // number of colors in the heap: the first ones of the venue
  int team_percent = 20;      // share of the heap's patches with a team's color
  int balls = 0;              // number of spots of the ball's color
  int ball_percent = 100;     // size of these spots relative to the ball
  int noise_per_mille = 0;    // share of runs of noise
  int noise_run = 1;          // length of the runs of noise
  int blur = 0;               // half width of the blur in pixels
  int seed = 1;
};

/// A number of ClutterRecipe, with its range.
struct ClutterNumber {
  const char* name;
  int ClutterRecipe::*value;
  int low, high;
};
std::span<const ClutterNumber> clutter_numbers();

/// Returns "robots 22 spacing 150 ...": all numbers in the order of clutter_numbers().
std::string text_of(const ClutterRecipe& recipe);
/// Returns nothing if the text does not have this form or a number is out of its range.
std::optional<ClutterRecipe> clutter_recipe_of(const std::string& text);

/// The slowest pictures that touchline-bench --search has found, each with a name.
struct NamedClutter {
  const char *name, *recipe;
};
std::span<const NamedClutter> worst_clutter();

/// Values of the three channels, in the color space of the camera's format.
using PixelValue = std::array<std::uint8_t, 3>;

/// Paints the picture in the venue's colors, row by row, in the size of `parameters.scan`. `background` is a value that
/// lies in no color box. The same recipe gives the same picture on every machine, except for rounding at edges.
std::vector<PixelValue> paint_clutter(const ClutterRecipe& recipe, const PipelineParameters& parameters,
                                      const CameraModel& camera, const PixelValue& background);

}  // namespace touchline::latency
