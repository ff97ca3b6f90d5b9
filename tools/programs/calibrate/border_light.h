#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/geometry/camera_model.h"
#include "core/geometry/field_area.h"
#include "core/status.h"
#include "tools/programs/calibrate/light_grid.h"

namespace touchline::calibrate {

/// A place of the field's border: pixels from the floor outwards, as indices in raster order. The border is what is
/// brightest among them.
using BorderPlace = std::vector<std::size_t>;

/// Every two centimeters along the field's sides, as the camera has them; not at the goals, nor near the corners, which
/// may be chamfered. Places outside the picture are left out.
std::vector<BorderPlace> border_places(const CameraModel& camera, const FieldParameters& field, std::size_t width_px,
                                       std::size_t height_px);

/// The light that the white border shows, continued over the field: per channel the logarithm of its value as a
/// quadratic polynomial of the place in the picture, fitted by least absolute deviations, so that what stands before
/// the border or shades it does not count. `background`: a plane a channel, 0 to 255; `cells`: one a channel, the
/// values that the border would show there. It tells how bright and of what tint the light is, and on which side there
/// is more; a lamp's spot in the field's middle it cannot tell. kNotFound, with the reason: a side of which too little
/// is seen, or of which most is saturated.
Status border_light(const std::array<Plane, 3>& background, const std::vector<BorderPlace>& places,
                    const LightGrid& grid, std::size_t width_px, std::size_t height_px, std::array<Plane, 3>& cells,
                    std::string& reason);

}  // namespace touchline::calibrate
