#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/marker/marker_layout.h"
#include "hal/mock/arena_parameters.h"
#include "hal/replay/picture.h"

namespace touchline::calibrate {

/// Red, green, blue, 0 to 255 with the sRGB transfer function.
using PaintRgb = std::array<double, 3>;

/// A robot as it stands on the field.
struct StandingRobot {
  Team team = Team::kOwn;
  int id = 0;
  double x_m = 0, y_m = 0, theta_rad = 0;
  // `paint` is in the order of the layout's patches; `glare` is the reflection of a lamp, as a share of white.
  std::vector<PaintRgb> paint;
  std::vector<double> glare;
};

/// Content of a picture.
struct TeamScene {
  MarkerLayout layout;
  std::vector<StandingRobot> robots;
  bool has_ball = true;
  double ball_x_m = 0, ball_y_m = 0, ball_radius_m = 0.02135;
  PaintRgb ball{}, floor{}, line{}, outside{}, body{};
};

/// Effects of lamps and camera in addition to those of the arena.
struct Exposure {
  std::array<double, 3> tint{1, 1, 1};
  double gain = 1, veil = 0;  // `veil` is stray light, as a share of white
  double blur_px = 0.7, noise = 2;
  bool shares_chroma = false;  // chroma is shared by two pixels of a row and two rows, as in a JPEG
};

/// Draws a scene: any layout, robots as cuboids, a shaded ball, the lines of the field, with the arena's lens and
/// lamps. It casts four rays per pixel, blurs, and adds the noise of 8-bit values.
hal::Picture draw_scene(const TeamScene& scene, const hal::mock::ArenaField& field,
                        const hal::mock::LensParameters& lens, const hal::mock::LightParameters& light,
                        const Exposure& exposure, int width_px, int height_px, unsigned seed);

}  // namespace touchline::calibrate
