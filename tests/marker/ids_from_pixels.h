#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <memory>

#include "tests/color/owned_picture.h"
#include "tests/marker/painted_colors.h"
#include "tests/marker/painted_field.h"
#include "tests/marker/portable_random.h"
#include "tests/marker/real_layouts.h"

// Fixture for ids from the pixels of a frame. The color boxes see one picture (`boxes`), the camera another one
// (`shown`): a patch that fell into no box is missing only in the first.
namespace touchline::testing {

inline TypicalColors typical_colors(ColorSpace space) {
  TypicalColors typical;
  for (ColorId color = kBlue; color <= kLime; ++color) {
    typical[color] = pixel_value(painted_rgb(color), space);
    typical.measured[color] = true;
  }
  return typical;
}

class IdsFromPixels : public ::testing::Test {
 protected:
  static constexpr Rgb kLampLight{0.75, 0.6, 0.45};
  static constexpr Placed kLeft{Team::kOwn, 0, {{-0.3f, 0.1f}, 0.4f}}, kMiddle{Team::kOwn, 1, {{0.0f, 0.1f}, -1.9f}},
      kRight{Team::kOwn, 2, {{0.3f, 0.1f}, 2.6f}};

  void use(const MarkerParameters& teams, PixelFormat pixel_format = PixelFormat::kRgb24) {
    parameters = teams;
    format = pixel_format;
    boxes = std::make_unique<PaintedField>(straight_camera(), teams);
    shown = std::make_unique<PaintedField>(straight_camera(), teams);
    boxes->set_typical_colors(typical_colors(color_space(format)));
  }
  void paint(const Placed& robot) {
    boxes->paint(robot);
    shown->paint(robot);
  }
  // Paints a robot of which only the team patch falls into its box.
  void paint_without_regions(const Placed& robot) {
    shown->paint(robot);
    boxes->paint_patch(robot, 0, parameters.teams[static_cast<std::size_t>(robot.team)].team_color);
  }
  // Sets the typical colors; colors in `repainted` are seen, and known, in another shade.
  void set_known_colors() {
    TypicalColors typical = typical_colors(color_space(format));
    for (const auto& [color, rgb] : repainted) typical[color] = pixel_value(rgb, color_space(format));
    boxes->set_typical_colors(typical);
  }
  // Runs the matcher; patches painted gray have the color `covered`.
  const Sightings& look(const Rgb& light = {1, 1, 1}, int noise = 3) {
    std::array<Rgb, 256> painted;
    for (std::size_t i = 0; i < painted.size(); ++i) {
      const auto color = static_cast<ColorId>(i);
      const auto other = repainted.find(color);
      painted[i] = color == kGrey ? covered : other != repainted.end() ? other->second : painted_rgb(color);
    }
    const auto shown_rgb = [&](int u, int v) { return painted[shown->grid().at(u, v)]; };
    // Returns the mean of the light (square of the value) of nine pixels.
    const auto blurred_rgb = [&](int u, int v) {
      Rgb sum{};
      for (int i = 0; i < 9; ++i) {
        const Rgb rgb = shown_rgb(std::clamp(u + i % 3 - 1, 0, 639), std::clamp(v + i / 3 - 1, 0, 479));
        for (std::size_t c = 0; c < 3; ++c) sum[c] += rgb[c] * rgb[c] / 9.0;
      }
      return Rgb{std::sqrt(sum[0]), std::sqrt(sum[1]), std::sqrt(sum[2])};
    };
    OwnedPicture picture(format, 640, 480, 0);
    for (int v = 0; v < 480; ++v) {
      for (int u = 0; u < 640; ++u) {
        Rgb rgb = is_blurred ? blurred_rgb(u, v) : shown_rgb(u, v);
        for (std::size_t c = 0; c < 3; ++c) {
          rgb[c] = std::min(clipped_at, light[c] * rgb[c] + random.whole(-noise, noise));
        }
        picture.set(u, v, pixel_value(rgb, color_space(format)));
      }
    }
    const Frame frame = picture.frame();
    return boxes->match(&frame);
  }

  MarkerParameters parameters;
  PixelFormat format = PixelFormat::kRgb24;
  Rgb covered{};
  std::map<ColorId, Rgb> repainted;
  double clipped_at = 255;  // highest value of the camera
  bool is_blurred = false;  // pixels at edges are mixtures, as behind a lens
  std::unique_ptr<PaintedField> boxes, shown;
  PortableRandom random{17};
};

}  // namespace touchline::testing
