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

/// [picture]: what the calibration was made for.
struct PictureEntry {
  std::uint16_t width_px = 640, height_px = 480;
  // No patch is a single pixel, and specks that are none take next to no time.
  std::uint32_t min_area_px = 2;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.number("width_px", self.width_px, Range{16, kMaxFrameWidth}, "px", "Width that the calibration is for");
    visit.number("height_px", self.height_px, Range{16, kMaxFrameHeight}, "px", "Height that the calibration is for");
    visit.number("min_area_px", self.min_area_px, Range{1, 10000}, "px", "Smaller regions are noise");
  }
};

/// [region_of_interest]: corners of a polygon in the picture; none: the whole picture.
struct RegionOfInterestEntry {
  std::vector<float> u_px, v_px;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.numbers("u_px", self.u_px, Range{-1, kMaxFrameWidth}, "px", "Columns of the polygon's corners");
    visit.numbers("v_px", self.v_px, Range{-1, kMaxFrameHeight}, "px", "Rows of the polygon's corners");
  }
};

struct LightEntry {
  std::string map, surface;
  std::vector<float> normal;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.text("map", self.map, "Illumination map beside this file, PNG of 16 bits, 32768 is 1; empty: no correction");
    visit.text("surface", self.surface, "What the map was measured on: grey, field, moving or border");
    visit.numbers("normal", self.normal, Range{1, 255}, "",
                  "What that surface shows in R, G, B where the map is 1, for touchline-calibrate light --keep-normal");
  }
};

/// [[color.box]]
struct ColorBoxEntry {
  std::array<std::uint8_t, 3> low{}, high{};

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.numbers("low", self.low, Range{0, 255}, "", "Least value of each channel");
    visit.numbers("high", self.high, Range{0, 255}, "", "Greatest value of each channel");
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
    visit.text("name", self.name, "What the team file calls it");
    visit.numbers("shown_rgb", self.shown_rgb, Range{0, 255}, "", "How it is drawn in annotated pictures");
    visit.numbers(
        "typical", self.typical, Range{0, 255}, "",
        "What its patches show on average, by channel, for the adaptation; none: the middle of its first box");
    visit.list("box", self.box, "A box of the color: R, G, B or Y, U, V, as [colors] says");
  }
};

inline constexpr std::array<Choice<ColorSpace>, 2> kColorSpaces{{{"rgb", ColorSpace::kRgb}, {"yuv", ColorSpace::kYuv}}};

struct ColorsEntry {
  ColorSpace space = ColorSpace::kRgb;
  std::vector<std::uint8_t> background;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.choice("space", self.space, std::span<const Choice<ColorSpace>>(kColorSpaces),
                 "What the boxes are in: must be what the camera's format delivers");
    visit.numbers("background", self.background, Range{0, 255}, "",
                  "What the floor shows on average, by channel: pixels like it are told at a glance; decides nothing "
                  "but the speed");
  }
};

/// venue.toml (docs/files.md): one hall, as the calibration tools found it.
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

  static constexpr std::array<std::string_view, 13> kRequired{
      "picture",        "field",         "camera_model",      "colors",       "picture.width_px", "picture.height_px",
      "field.length_m", "field.width_m", "camera_model.kind", "colors.space", "color.name",       "color.box.low",
      "color.box.high"};

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.number("version", self.version, kVersionRange, "", "Of this file's keys");
    visit.section("picture", self.picture, "The picture that all of this was made for");
    visit.section("field", self.field, "The field and its goals; origin in the center, x to the opponent's goal");
    visit.section("camera_model", self.camera_model, "Where a pixel looks to");
    visit.section("region_of_interest", self.region_of_interest, "What is looked at; no corners: the whole picture");
    visit.section("light", self.light, "Uneven illumination");
    visit.section("colors", self.colors, "All colors");
    visit.section("adaptation", self.adaptation, "How light map and boxes follow the light while the robots play");
    visit.list("color", self.color, "A color that patches or the ball have");
  }
};

}  // namespace touchline::config
