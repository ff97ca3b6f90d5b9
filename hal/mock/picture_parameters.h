#pragma once

#include <array>
#include <vector>

#include "core/parameter.h"
#include "hal/mock/bayer_pattern.h"

// The part of section [arena] that decides how a scene becomes a picture: lamps, lens and image sensor.
namespace touchline::hal::mock {

struct LampParameters {
  double x_m = 0.0, y_m = 0.0, z_m = 2.5;
  double power = 1.0;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.number(self.x_m, {.name = "x_m", .range = {-50.0, 50.0}, .unit = "m", .help = "Position"});
    visit.number(self.y_m, {.name = "y_m", .range = {-50.0, 50.0}, .unit = "m", .help = "Position"});
    visit.number(self.z_m, {.name = "z_m", .range = {0.3, 50.0}, .unit = "m", .help = "Height"});
    visit.number(self.power, {.name = "power", .range = {0.0, 1000.0}, .help = "Power relative to the other lamps"});
  }
};

struct LightParameters {
  double ambient = 0.35;
  double exposure = 1.0;
  std::vector<LampParameters> lamp{{-0.9, 0.7, 2.2, 1.0}, {0.8, 0.9, 2.4, 0.9}, {1.0, -0.8, 2.2, 0.8}};

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.number(self.ambient, {.name = "ambient", .range = {0.0, 1.0}, .help = "Fraction of ambient light"});
    visit.number(self.exposure, {.name = "exposure",
                                 .range = {0.05, 20.0},
                                 .help = "Exposure; 1: the mean of white paper on the field is 90 % of full scale"});
    visit.list(self.lamp, {.name = "lamp", .help = "A lamp: inverse-square law and cosine of the angle of incidence"});
  }
};

struct LensParameters {
  double focal_px = 560.0;
  double cubic = -0.03;
  double center_u_px = 322.0, center_v_px = 238.0;
  std::array<double, 3> position_m{0.10, -0.12, 2.3};
  std::array<double, 2> aim_m{0.0, 0.0};
  double roll_rad = 0.02;
  double vignetting = 0.15;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.number(self.focal_px, {.name = "focal_px",
                                 .range = {10.0, 1e5},
                                 .unit = "px",
                                 .help = "f of r = f (a + cubic a^3), a: angle to the axis (Kannala and Brandt 2006)"});
    visit.number(self.cubic, {.name = "cubic", .range = {-0.2, 1.0}, .help = "Factor of the cubic term"});
    visit.number(self.center_u_px,
                 {.name = "center_u_px", .range = {-1e4, 1e4}, .unit = "px", .help = "Principal point"});
    visit.number(self.center_v_px,
                 {.name = "center_v_px", .range = {-1e4, 1e4}, .unit = "px", .help = "Principal point"});
    visit.numbers(self.position_m, {.name = "position_m",
                                    .range = {-50.0, 50.0},
                                    .unit = "m",
                                    .help = "Position of the camera in the field frame"});
    visit.numbers(self.aim_m, {.name = "aim_m",
                               .range = {-50.0, 50.0},
                               .unit = "m",
                               .help = "Point on the floor that the optical axis meets"});
    visit.number(self.roll_rad,
                 {.name = "roll_rad", .range = {-3.2, 3.2}, .unit = "rad", .help = "Rotation about the optical axis"});
    visit.number(self.vignetting, {.name = "vignetting",
                                   .range = {0.0, 0.9},
                                   .help = "Fraction of the light that is lost in the corners of the picture"});
  }
};

struct SensorParameters {
  double full_well_electrons = 9000.0;
  double read_noise_electrons = 18.0;
  double gamma = 2.2;
  double exposure_s = 0.004;
  double readout_s = 0.0;
  double transfer_s = 0.007;
  double blur_px = 0.0;
  BayerPattern bayer = BayerPattern::kNone;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.number(self.full_well_electrons, {.name = "full_well_electrons",
                                            .range = {100.0, 1e7},
                                            .help = "Electrons at full scale; their square root is the shot noise"});
    visit.number(self.read_noise_electrons,
                 {.name = "read_noise_electrons", .range = {0.0, 1e4}, .help = "Read noise (standard deviation)"});
    visit.number(self.gamma, {.name = "gamma", .range = {1.0, 3.0}, .help = "Gamma of the camera's tone curve"});
    visit.number(
        self.exposure_s,
        {.name = "exposure_s", .range = {0.0, 0.1}, .unit = "s", .help = "Exposure time, which causes motion blur"});
    visit.number(self.readout_s, {.name = "readout_s",
                                  .range = {0.0, 0.1},
                                  .unit = "s",
                                  .help = "Rolling shutter: time from the exposure of the first row to that of the "
                                          "last row; 0: global shutter"});
    visit.number(self.transfer_s, {.name = "transfer_s",
                                   .range = {0.0, 0.5},
                                   .unit = "s",
                                   .help = "Delay from the end of the exposure until the frame is in memory"});
    visit.number(self.blur_px, {.name = "blur_px",
                                .range = {0.0, 10.0},
                                .unit = "px",
                                .help = "Standard deviation of the lens's blur; 0: sharp"});
    visit.choice(self.bayer, kBayerPatterns,
                 {.name = "bayer",
                  .help = "Color filters of the first two rows and columns; missing colors are interpolated "
                          "bilinearly; none: each pixel measures all colors"});
  }
};

}  // namespace touchline::hal::mock
