#pragma once

#include <array>
#include <vector>

#include "hal/mock/arena_parameters.h"

namespace touchline::hal::mock {

/// Reflectance of a surface, or light that it sends to the camera; 1 is white.
using Linear = std::array<float, 3>;

/// A color as a person picks it (sRGB) as reflectance.
Linear reflectance(const Rgb& srgb);

/// Lamps with inverse-square falloff and the light that comes from everywhere, scaled so that the floor's average is 1.
class Lighting {
 public:
  Lighting(const LightParameters& light, const FieldParameters& field);

  /// On a horizontal surface.
  [[nodiscard]] float on_level(float x_m, float y_m, float z_m) const;
  [[nodiscard]] float ambient() const { return ambient_; }

  /// What a lamp does at a place: unit vector towards it, and strength where the light falls in at right angles.
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
