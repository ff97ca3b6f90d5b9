#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/adaptation.h"
#include "core/geometry/camera_model.h"
#include "core/marker/matcher.h"
#include "core/parameter.h"
#include "core/region/region_scanner.h"
#include "core/types.h"
#include "firmware/config/board_file.h"

namespace touchline::config {

/// [picture]: size of the pictures for which the calibration was made.
struct PictureEntry {
  std::uint16_t width_px = 640, height_px = 480;
  // The defaults exclude single pixels and single rows, because no patch is so small.
  std::uint32_t min_area_px = 2, min_height_px = 2;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.number(
        self.width_px,
        {.name = "width_px", .range = {16, kMaxFrameWidth}, .unit = "px", .help = "Width of the calibrated picture"});
    visit.number(self.height_px, {.name = "height_px",
                                  .range = {16, kMaxFrameHeight},
                                  .unit = "px",
                                  .help = "Height of the calibrated picture"});
    visit.number(self.min_area_px, {.name = "min_area_px",
                                    .range = {1, 10000},
                                    .unit = "px",
                                    .reload = Reload::kThresholds,
                                    .help = "Smaller regions are ignored; from 2 on, single pixels cost no time"});
    visit.number(self.min_height_px,
                 {.name = "min_height_px",
                  .range = {1, 100},
                  .unit = "px",
                  .reload = Reload::kThresholds,
                  .help = "Regions of fewer rows are ignored; from 2 on, half of the background is not read"});
  }
};

/// [region_of_interest]: corners of a polygon in the picture; empty: the whole picture.
struct RegionOfInterestEntry {
  std::vector<float> u_px, v_px;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.numbers(self.u_px,
                  {.name = "u_px", .range = {-1, kMaxFrameWidth}, .unit = "px", .help = "Columns of the corners"});
    visit.numbers(self.v_px,
                  {.name = "v_px", .range = {-1, kMaxFrameHeight}, .unit = "px", .help = "Rows of the corners"});
  }
};

struct LightEntry {
  std::string map, surface, reference;
  std::vector<float> normal;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.text(self.map, {.name = "map",
                          .help = "Illumination map in the folder of this file: PNG with 16 bits per channel, 32768 "
                                  "means 1; empty: no correction"});
    visit.text(self.surface,
               {.name = "surface", .help = "Surface that the map was measured on: grey, field, moving or border"});
    visit.numbers(self.normal,
                  {.name = "normal",
                   .range = {1, 255},
                   .help = "R, G, B of that surface where the map is 1, for touchline-calibrate light --keep-normal"});
    visit.text(self.reference,
               {.name = "reference",
                .help = "The field in the light in which the colors were learned, in the folder of this file: PNG with "
                        "16 bits per channel, one pixel per cell. The adaptation measures the present light by it; "
                        "empty: only from recognized robots"});
  }
};

/// [[color.box]]
struct ColorBoxEntry {
  std::array<std::uint8_t, 3> low{}, high{};

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.numbers(self.low, {.name = "low", .range = {0, 255}, .help = "Lowest value of each channel"});
    visit.numbers(self.high, {.name = "high", .range = {0, 255}, .help = "Highest value of each channel"});
  }
};

/// [[color]]: a class of pixels, the union of its boxes.
struct ColorEntry {
  std::string name;
  std::array<std::uint8_t, 3> shown_rgb{255, 255, 255};
  std::vector<std::uint8_t> typical;
  std::vector<ColorBoxEntry> box;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.text(self.name, {.name = "name", .help = "Name for the team file"});
    visit.numbers(self.shown_rgb, {.name = "shown_rgb", .range = {0, 255}, .help = "Color in annotated pictures"});
    visit.numbers(self.typical, {.name = "typical",
                                 .range = {0, 255},
                                 .help = "Mean value of its patches after correction by the light map, each channel, "
                                         "for [adaptation] and for ids from pixels; absent: the middle of the first "
                                         "box, and ids from boxes only"});
    visit.list(self.box, {.name = "box", .help = "A box in color space: R, G, B or Y, U, V, see colors.space"});
  }
};

inline constexpr std::array<Choice<ColorSpace>, 3> kColorSpaceWords{
    {{"rgb", ColorSpace::kRgb}, {"yuv", ColorSpace::kYuv}, {"yuv_full_range", ColorSpace::kYuvFullRange}}};

struct ColorsEntry {
  ColorSpace space = ColorSpace::kRgb;
  std::vector<std::uint8_t> background;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.choice(self.space, kColorSpaceWords,
                 {.name = "space",
                  .help = "Color space of the boxes; must match camera.format: yuv_full_range for mjpg and yuvj422p"});
    visit.numbers(self.background,
                  {.name = "background",
                   .range = {0, 255},
                   .reload = Reload::kThresholds,
                   .help = "Mean value of the floor after correction by the light map, each channel: similar pixels "
                           "are rejected early. Affects only the speed; absent: black"});
  }
};

/// [noise]: scatter of the poses of robots and ball at rest beyond the noise that the pictures show, for example
/// because the camera shakes.
struct NoiseEntry {
  double robot_position_m = 0.0, robot_heading_rad = 0.0, ball_position_m = 0.0;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.number(
        self.robot_position_m,
        {.name = "robot_position_m",
         .range = {0.0, 0.1},
         .unit = "m",
         .help = "Standard deviation of a standing robot's sighted position from picture to picture, each axis, "
                 "beside the noise that its picture shows; adds to tracking.robot.position_jitter_m"});
    visit.number(self.robot_heading_rad,
                 {.name = "robot_heading_rad",
                  .range = {0.0, 1.0},
                  .unit = "rad",
                  .help = "The same of its heading; adds to tracking.robot.heading_jitter_rad"});
    visit.number(self.ball_position_m,
                 {.name = "ball_position_m",
                  .range = {0.0, 0.1},
                  .unit = "m",
                  .help = "The same of the ball's position; adds to tracking.ball.position_jitter_m"});
  }
};

/// venue.toml (docs/files.md): one hall, written by touchline-calibrate.
struct VenueFile {
  int version = kFileVersion;
  PictureEntry picture;
  FieldParameters field;
  CameraParameters camera_model;
  RegionOfInterestEntry region_of_interest;
  LightEntry light;
  ColorsEntry colors;
  std::vector<ColorEntry> color;
  AdaptationParameters adaptation;
  NoiseEntry noise;

  static constexpr std::array<std::string_view, 13> kRequired{
      "picture",        "field",         "camera_model",      "colors",       "picture.width_px", "picture.height_px",
      "field.length_m", "field.width_m", "camera_model.kind", "colors.space", "color.name",       "color.box.low",
      "color.box.high"};

  // With a source of poses (camera.backend).
  static constexpr std::array<std::string_view, 3> kRequiredForPoses{"field", "field.length_m", "field.width_m"};

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.number(self.version, {.name = "version", .range = kVersionRange, .help = "Version of the file format"});
    visit.section(self.picture, {.name = "picture", .help = "The picture that the calibration was made for"});
    visit.section(self.field,
                  {.name = "field",
                   .help = "The field and its goals; the origin is the center, x points to the opponent's goal"});
    visit.section(self.camera_model, {.name = "camera_model", .help = "The camera model: from pixels to rays"});
    visit.section(self.region_of_interest,
                  {.name = "region_of_interest",
                   .reload = Reload::kThresholds,
                   .help = "Polygon in the picture outside of which pixels are ignored; absent: the whole picture"});
    visit.section(self.light, {.name = "light",
                               .reload = Reload::kThresholds,
                               .help = "Correction of uneven illumination (docs/light-and-colors.md)"});
    visit.section(self.colors, {.name = "colors", .help = "Settings of all colors"});
    visit.section(self.adaptation, {.name = "adaptation",
                                    .reload = Reload::kThresholds,
                                    .help = "Adaptation of light map and color boxes to the light while robots play"});
    visit.section(
        self.noise,
        {.name = "noise", .help = "Noise of standing robots and of the ball, measured by touchline-calibrate noise"});
    visit.list(self.color, {.name = "color", .reload = Reload::kThresholds, .help = "A color of patches or ball"});
  }
};

}  // namespace touchline::config
