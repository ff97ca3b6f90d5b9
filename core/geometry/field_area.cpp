#include "core/geometry/field_area.h"

#include <cmath>

namespace touchline {

bool inside_field(const FieldParameters& field, FieldPoint point) {
  const float x = std::abs(point.x_m), y = std::abs(point.y_m);
  const float half_length = 0.5f * field.length_m + field.margin_m;
  if (x <= half_length && y <= 0.5f * field.width_m + field.margin_m) return true;
  if (!(field.goal_width_m > 0.0f)) return false;
  return x <= half_length + field.goal_depth_m && y <= 0.5f * field.goal_width_m + field.margin_m;
}

}  // namespace touchline
