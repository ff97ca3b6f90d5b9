#pragma once

#include <array>

#include "core/geometry/camera_model.h"
#include "core/marker/marker_layout.h"
#include "core/marker/surface_color.h"
#include "core/types.h"

namespace touchline {

using PaintColors = FixedVector<SurfaceColor, kMaxPatches>;

/// Finds the colors of a robot's patches as they would be if no lamp were mirrored in its top. A lamp adds white light
/// that varies smoothly over the top: in linear light, a pixel at x of surface k (a patch, or the free top) shows
/// L_k + g + q(x), where q has the terms x, y, x^2, xy and y^2. Least squares over all pixels that show a single
/// surface give q: each surface's own mean is projected out. The free top shows g, because its light without a lamp is
/// `usual_top` (R, G, B; 1: pixel value 255).
///
/// `saturated_from`: as in SurfaceColor. `out`: by patch of the layout, with the errors of the means in `spread`. A
/// channel that the lamp saturates is a lower bound. The work is 256 samples. False if the top or a patch shows too few
/// pixels, as where patches leave gaps of a pixel, if a patch is white, if a channel of the top is saturated, or if the
/// light of the surfaces is uneven beyond the lamp.
bool see_paints(const Frame& frame, const CameraModel& camera, const MarkerLayout& layout, const Pose& pose,
                const std::array<float, 3>& usual_top, int saturated_from, PaintColors& out);

}  // namespace touchline
