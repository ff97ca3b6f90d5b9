#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/geometry/camera_model.h"
#include "core/marker/matcher.h"
#include "hal/replay/picture.h"

namespace touchline::rectify {

inline constexpr std::uint32_t kWidth = 320, kHeight = 240;

/// Returns a tilted camera with lens distortion above a field of 1.5 x 1.3 m, and Klancar's model of nearly the same
/// view.
inline CameraParameters distorted_camera() {
  CameraParameters camera;
  camera.full = {270, 270, 160, 118, -0.35f, 0.09f, 0, 0.001f, -0.001f, {3.0f, 0.05f, 0.1f}, {0.05f, -0.2f, 1.9f}};
  camera.paper = {159.5f, 119.5f, 250, -1e-4f, 2e-4f, {0.007f, 0, 0.05f, 0, -0.007f, -0.2f}, {0.05f, -0.2f, 1.9f}};
  return camera;
}

inline FieldParameters small_field() {
  FieldParameters field;
  field.length_m = 1.5f;
  field.width_m = 1.3f;
  field.goal_depth_m = 0.1f;
  return field;
}

/// Renders the dark field, its bright border (5 cm) and grey surroundings with this camera: 4 x 4 rays per pixel, sRGB
/// with exponent 2.2.
inline hal::Picture photograph(const CameraParameters& parameters, const FieldParameters& field) {
  CameraModel camera;
  if (!camera.configure(parameters).ok()) return {};
  hal::Picture picture;
  picture.width_px = kWidth;
  picture.height_px = kHeight;
  for (std::uint32_t v = 0; v < kHeight; ++v) {
    for (std::uint32_t u = 0; u < kWidth; ++u) {
      const auto point_at = [&](float du, float dv) {
        return camera.to_field({static_cast<float>(u) + du, static_cast<float>(v) + dv}, 0.0f);
      };
      // The projection is linear within a pixel.
      const FieldPoint at = point_at(0, 0), right = point_at(1, 0), below = point_at(0, 1);
      double light = 0;
      for (int ray = 0; ray < 16; ++ray) {
        const float du = (static_cast<float>(ray % 4) + 0.5f) / 4 - 0.5f;
        const float dv = (static_cast<float>(ray / 4) + 0.5f) / 4 - 0.5f;
        const float x = at.x_m + du * (right.x_m - at.x_m) + dv * (below.x_m - at.x_m);
        const float y = at.y_m + du * (right.y_m - at.y_m) + dv * (below.y_m - at.y_m);
        const float beyond = std::max(std::abs(x) - field.length_m / 2, std::abs(y) - field.width_m / 2);
        light += (beyond < 0 ? 0.05 : beyond < 0.05f ? 0.8 : 0.2) / 16;
      }
      picture.rgb8.insert(picture.rgb8.end(), 3,
                          static_cast<std::uint8_t>(std::lround(255 * std::pow(light, 1 / 2.2))));
    }
  }
  return picture;
}

}  // namespace touchline::rectify
