#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/pipeline.h"

namespace touchline::latency {

/// Describes a picture that is expensive for the whole step, in a few numbers: robots of the venue's teams, which may
/// overlap; a heap of patches; spots of the ball's color; noise; and blur over all of it.
struct ClutterRecipe {
  int robots = 0;             // of both teams in turn
  int spacing_percent = 150;  // of the robots' grid, relative to their side
  int covered_percent = 0;    // robots with a black bar across their top
  int heap = 0;               // patches
  int patch_percent = 100;    // their size relative to a team patch
  int aspect_percent = 100;   // width / length
  int spread_percent = 100;   // part of the picture's width and height that the heap takes
  int colors = 13;            // of the heap: the first ones of the venue
  int team_percent = 20;      // patches of the heap with a team's color
  int balls = 0;              // spots of the ball's color
  int ball_percent = 100;     // their size relative to the ball
  int noise_per_mille = 0;    // share of runs of noise
  int noise_run = 1;          // their length
  int blur = 0;               // half width of the blur in pixels
  int seed = 1;
};

/// A number of ClutterRecipe with its range.
struct ClutterNumber {
  const char* name;
  int ClutterRecipe::*value;
  int low, high;
};
std::span<const ClutterNumber> clutter_numbers();

/// "robots 22 spacing 150 ...": all numbers in the order of clutter_numbers().
std::string text_of(const ClutterRecipe& recipe);
/// Nothing if the text does not have this form or a number is out of its range.
std::optional<ClutterRecipe> clutter_recipe_of(const std::string& text);

/// The most expensive pictures that touchline-bench --search has found, each with a name.
struct NamedClutter {
  const char *name, *recipe;
};
std::span<const NamedClutter> worst_clutter();

/// Values of the three channels, in the color space of the camera's format.
using PixelValue = std::array<std::uint8_t, 3>;

/// Paints the picture in the venue's colors, row by row, in the size of `parameters.scan`. `background` is a value in
/// no color box. The same recipe gives the same picture on every machine, except for rounding at edges.
std::vector<PixelValue> paint_clutter(const ClutterRecipe& recipe, const PipelineParameters& parameters,
                                      const CameraModel& camera, const PixelValue& background);

}  // namespace touchline::latency
