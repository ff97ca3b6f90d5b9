#include "hal/mock/lighting.h"

#include <cmath>

namespace touchline::hal::mock {
namespace {

// The sRGB transfer function, IEC 61966-2-1.
float srgb_to_linear(int value) {
  const double v = value / 255.0;
  return static_cast<float>(v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4));
}

}  // namespace

LinearRgb reflectance(const Srgb& srgb) {
  return {srgb_to_linear(srgb[0]), srgb_to_linear(srgb[1]), srgb_to_linear(srgb[2])};
}

Lighting::Lighting(const LightParameters& light, const ArenaField& field) {
  for (const LampParameters& lamp : light.lamp) {
    lamps_.push_back({static_cast<float>(lamp.x_m), static_cast<float>(lamp.y_m), static_cast<float>(lamp.z_m),
                      static_cast<float>(lamp.power)});
  }
  constexpr int kGrid = 24;
  double sum = 0.0;
  for (int i = 0; i < kGrid; ++i) {
    for (int k = 0; k < kGrid; ++k) {
      sum += static_cast<double>(irradiance(static_cast<float>(((i + 0.5) / kGrid - 0.5) * field.length_m),
                                            static_cast<float>(((k + 0.5) / kGrid - 0.5) * field.width_m), 0.0f));
    }
  }
  const double mean = sum / (kGrid * kGrid);
  // If no lamp has any power, all light is ambient.
  const double ambient = mean > 0.0 ? light.ambient : 1.0;
  ambient_ = static_cast<float>(ambient);
  for (Lamp& lamp : lamps_) {
    lamp.power = mean > 0.0 ? static_cast<float>(static_cast<double>(lamp.power) * (1.0 - ambient) / mean) : 0.0f;
  }
}

Lighting::Beam Lighting::beam(std::size_t lamp, float x_m, float y_m, float z_m) const {
  const Lamp& from = lamps_[lamp];
  const float x = from.x_m - x_m, y = from.y_m - y_m, z = from.z_m - z_m;
  const float square = x * x + y * y + z * z;
  const float distance = std::sqrt(square);
  return {{x / distance, y / distance, z / distance}, from.power / square};
}

float Lighting::irradiance(float x_m, float y_m, float z_m) const {
  float sum = ambient_;
  for (std::size_t i = 0; i < lamps_.size(); ++i) {
    const Beam light = beam(i, x_m, y_m, z_m);
    if (light.towards[2] > 0.0f) sum += light.strength * light.towards[2];
  }
  return sum;
}

}  // namespace touchline::hal::mock
