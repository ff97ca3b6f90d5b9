#pragma once

#include <gtest/gtest.h>

#include "tests/geometry/reference_camera.h"

namespace touchline::testing {

inline CameraModel model_of(const CameraParameters& parameters) {
  CameraModel out;
  EXPECT_TRUE(out.configure(parameters).ok());
  return out;
}

/// Checks pixel -> field -> pixel over the whole picture, at every height; a few pixels may be above the horizon.
inline void expect_round_trips(const CameraModel& model) {
  int over = 0;
  for (const PixelPoint pixel : whole_picture()) {
    if (over_horizon(model, pixel)) {
      ++over;
      continue;
    }
    for (const float height : kHeights) {
      EXPECT_LT(distance(model.to_pixel(model.to_field(pixel, height), height), pixel), 1e-3)
          << pixel.u_px << ' ' << pixel.v_px << ' ' << height;
    }
  }
  EXPECT_LT(over, 100) << "of 5084 pixels";
}

}  // namespace touchline::testing
