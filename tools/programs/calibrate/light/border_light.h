#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/geometry/camera_model.h"
#include "core/geometry/field_area.h"
#include "hal/result.h"
#include "tools/programs/calibrate/light/light_grid.h"

namespace touchline::calibrate {

/// Pixels along a line from the floor outwards across the border of the field, as indices in raster order. The
/// brightest of them belong to the border.
using BorderPlace = std::vector<std::size_t>;

/// Returns a place every two centimeters along the sides of the field, projected with the camera model. Skips goals and
/// corners, which may be chamfered, and places outside the picture.
std::vector<BorderPlace> border_places(const CameraModel& camera, const FieldParameters& field, std::size_t width_px,
                                       std::size_t height_px);

/// Estimates the illumination of the field from its white border. For each channel, the logarithm of the border's value
/// is a quadratic polynomial of the position in the picture, fitted by least absolute deviations, so that objects or
/// shadows on the border have little influence. `background`: one plane per channel, 0 to 255. `cells`: one plane per
/// channel, the value that the border would have at each cell. The result shows brightness, tint and gradient of the
/// light. It cannot show a bright spot in the middle of the field. kNotFound, with the reason: too little of the border
/// is visible, or most of it is saturated.
Result<void> border_light(const std::array<Plane, 3>& background, const std::vector<BorderPlace>& places,
                          const LightGrid& grid, std::size_t width_px, std::size_t height_px,
                          std::array<Plane, 3>& cells);

}  // namespace touchline::calibrate
