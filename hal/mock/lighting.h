#pragma once

#include <array>
#include <vector>

#include "hal/mock/arena_parameters.h"

namespace touchline::hal::mock {

/// Linear R, G, B: the reflectance of a surface, or the light that it reflects to the camera. 1 is white.
using LinearRgb = std::array<float, 3>;

/// Converts an sRGB color (0 to 255 per channel) to linear reflectance.
LinearRgb reflectance(const Srgb& srgb);

/// Point lamps with inverse-square falloff plus ambient light, scaled to a mean irradiance of 1 on the field.
class Lighting {
 public:
  Lighting(const LightParameters& light, const ArenaField& field);

  /// Returns the irradiance of a horizontal surface at this point.
  [[nodiscard]] float irradiance(float x_m, float y_m, float z_m) const;
  [[nodiscard]] float ambient() const { return ambient_; }

  /// Light of one lamp at one point: the unit vector towards the lamp, and the irradiance at perpendicular incidence.
  struct Beam {
    std::array<float, 3> towards{};
    float strength = 0.0f;
  };
  [[nodiscard]] Beam beam(std::size_t lamp, float x_m, float y_m, float z_m) const;
  [[nodiscard]] std::size_t lamps() const { return lamps_.size(); }

 private:
  struct Lamp {
    float x_m, y_m, z_m, power;
  };
  std::vector<Lamp> lamps_;
  float ambient_ = 0.0f;
};

}  // namespace touchline::hal::mock
