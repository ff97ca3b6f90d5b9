#include "core/marker/outline_cover.h"

#include <algorithm>
#include <cmath>

namespace touchline {
namespace {

// What an edge leaves of a pixel that lies `outside_m` beyond it.
struct Edge {
  float value = 0, slope = 0;  // slope: derivative by outside_m
};

Edge ramp(float outside_m, float ramp_m) {
  const float value = 0.5f - outside_m / ramp_m;
  if (value <= 0.0f) return {0.0f, 0.0f};
  if (value >= 1.0f) return {1.0f, 0.0f};
  return {value, -1.0f / ramp_m};
}

}  // namespace

OutlineCover::OutlineCover(const PatchPlace& place)
    : outline_(place.outline),
      half_length_m_(0.5f * place.length_m),
      half_width_m_(0.5f * place.width_m),
      width_m_(std::min(place.length_m, place.width_m)),
      cos_(std::cos(place.turn_rad)),
      sin_(std::sin(place.turn_rad)) {
  switch (place.outline) {
    case PatchOutline::kCircle:
      radius_m_ = std::max(half_length_m_, half_width_m_);
      break;
    case PatchOutline::kTriangle:
      radius_m_ = std::max(4.0f / 3.0f * half_length_m_, std::hypot(2.0f / 3.0f * half_length_m_, half_width_m_));
      width_m_ *= 0.5f;  // of the inscribed circle, as good as
      break;
    case PatchOutline::kSquare:
    case PatchOutline::kBar:
      radius_m_ = std::hypot(half_length_m_, half_width_m_);
      break;
  }
}

Cover OutlineCover::at(float x_m, float y_m, float ramp_m) const {
  const float x = cos_ * x_m + sin_ * y_m, y = cos_ * y_m - sin_ * x_m;
  float value = 0, dx = 0, dy = 0;  // derivatives by x and y of the pixel, in the outline's own axes
  switch (outline_) {
    case PatchOutline::kSquare:
    case PatchOutline::kBar: {
      const float beyond = std::max(std::abs(x) - half_length_m_, std::abs(y) - half_width_m_);
      if (2.0f * beyond >= ramp_m) return {};
      if (2.0f * beyond <= -ramp_m) return {1.0f, 0.0f, 0.0f};
      const Edge along = ramp(std::abs(x) - half_length_m_, ramp_m), across = ramp(std::abs(y) - half_width_m_, ramp_m);
      value = along.value * across.value;
      dx = std::copysign(along.slope, -x) * across.value;
      dy = std::copysign(across.slope, -y) * along.value;
      break;
    }
    case PatchOutline::kCircle: {
      // An ellipse is a circle in stretched axes; its edge's distance is right to first order.
      const float sx = x / half_length_m_, sy = y / half_width_m_;
      const float r = std::sqrt(sx * sx + sy * sy), size = std::min(half_length_m_, half_width_m_);
      const Edge edge = ramp((r - 1.0f) * size, ramp_m);
      value = edge.value;
      if (edge.slope != 0.0f && r > 0.0f) {
        dx = edge.slope * size * sx / (r * half_length_m_);
        dy = edge.slope * size * sy / (r * half_width_m_);
      }
      break;
    }
    case PatchOutline::kTriangle: {
      const float third = 2.0f / 3.0f * half_length_m_;  // from the centroid to the base; twice that to the tip
      const float norm = std::hypot(half_width_m_, 2.0f * half_length_m_);
      const float nx = half_width_m_ / norm, ny = 2.0f * half_length_m_ / norm;
      const Edge base = ramp(-x - third, ramp_m);
      const Edge left = ramp(nx * (x - 2.0f * third) + ny * y, ramp_m);
      const Edge right = ramp(nx * (x - 2.0f * third) - ny * y, ramp_m);
      value = base.value * left.value * right.value;
      dx = -base.slope * left.value * right.value +
           nx * base.value * (left.slope * right.value + left.value * right.slope);
      dy = ny * base.value * (left.slope * right.value - left.value * right.slope);
      break;
    }
  }
  return {value, -(cos_ * dx - sin_ * dy), -(sin_ * dx + cos_ * dy)};
}

}  // namespace touchline
