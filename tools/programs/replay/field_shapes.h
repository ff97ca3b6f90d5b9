#pragma once

#include <cairo.h>

#include "core/geometry/camera_model.h"
#include "core/types.h"

// Adds paths to a Cairo context whose user space is pixel coordinates of the picture. The caller strokes or fills them.
// Points of the field are projected at `height_m` above the floor.
namespace touchline::replay {

/// Returns the point `forward_m` ahead and `left_m` to the left of a pose.
FieldPoint point_ahead(const Pose& pose, float forward_m, float left_m);

void line_on_field(cairo_t& context, const CameraModel& camera, FieldPoint from, FieldPoint to, float height_m);
/// Adds an ellipse with axes parallel to the axes of the field.
void circle_on_field(cairo_t& context, const CameraModel& camera, FieldPoint center, float radius_x_m, float radius_y_m,
                     float height_m);
void square_on_field(cairo_t& context, const CameraModel& camera, const Pose& pose, float side_m, float height_m);
void arrow_on_field(cairo_t& context, const CameraModel& camera, FieldPoint from, FieldPoint to, float height_m);

/// Adds the boundary of a region along the edges of its pixels, which shows exactly which pixels belong to it.
void region_outline(cairo_t& context, const Runs& runs, const Region& region);

}  // namespace touchline::replay
