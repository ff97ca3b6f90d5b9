#pragma once

#include "hal/mock/renderer.h"
#include "hal/mock/sensor.h"
#include "hal/replay/picture.h"

namespace touchline::calibrate {

/// Takes a picture of the floor with the arena's camera, with noise: RGB, 640 x 480.
inline constexpr std::uint16_t kWidth = 640, kHeight = 480;

/// `objects`: robots and ball on the field; none by default.
inline hal::Picture photograph(const hal::mock::ArenaParameters& arena, hal::mock::Floor floor, std::uint64_t seed,
                               const hal::mock::Snapshot* objects = nullptr) {
  hal::mock::Renderer renderer(arena, kWidth, kHeight, floor);
  hal::mock::Sensor sensor(arena.sensor, PixelFormat::kRgb24, kWidth, kHeight, seed);
  hal::Picture picture;
  picture.width_px = kWidth;
  picture.height_px = kHeight;
  picture.rgb8.resize(std::size_t{3} * kWidth * kHeight);
  sensor.expose(objects == nullptr ? renderer.render_floor() : renderer.render(*objects, *objects), picture.rgb8);
  return picture;
}

}  // namespace touchline::calibrate
