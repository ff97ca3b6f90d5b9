#include "core/subpixel/blurred_outline.h"

#include <algorithm>
#include <cmath>

namespace touchline {

BlurredOutline::BlurredOutline(const PatchPlace& place)
    : outline_(place.outline),
      half_length_m_(0.5f * place.length_m),
      half_width_m_(0.5f * place.width_m),
      reach_x_m_(half_length_m_),
      width_m_(std::min(place.length_m, place.width_m)),
      cos_(std::cos(place.turn_rad)),
      sin_(std::sin(place.turn_rad)) {
  if (place.outline != PatchOutline::kTriangle) return;
  reach_x_m_ = 4.0f / 3.0f * half_length_m_;
  width_m_ *= 0.5f;  // close to the diameter of the inscribed circle
  const float norm = std::hypot(half_width_m_, 2.0f * half_length_m_);
  nx_ = half_width_m_ / norm;
  ny_ = 2.0f * half_length_m_ / norm;
}

FieldPoint BlurredOutline::half_box(float ramp_m) const {
  switch (outline_) {
    case PatchOutline::kCircle: {
      const float wider = 1.0f + 0.5f * ramp_m / std::min(half_length_m_, half_width_m_);
      return {wider * half_length_m_, wider * half_width_m_};
    }
    case PatchOutline::kTriangle:
      return {reach_x_m_ + 0.71f * ramp_m, half_width_m_ + 0.71f * ramp_m};
    case PatchOutline::kSquare:
    case PatchOutline::kBar:
      break;
  }
  return {half_length_m_ + 0.5f * ramp_m, half_width_m_ + 0.5f * ramp_m};
}

FieldPoint BlurredOutline::inner_box(float ramp_m) const {
  if (outline_ == PatchOutline::kTriangle || width_m_ <= ramp_m) return {};
  if (outline_ == PatchOutline::kCircle) {
    // The inscribed square, stretched like the circle.
    const float part = 0.7f * (1.0f - 0.5f * ramp_m / std::min(half_length_m_, half_width_m_));
    return {part * half_length_m_, part * half_width_m_};
  }
  return {half_length_m_ - 0.5f * ramp_m, half_width_m_ - 0.5f * ramp_m};
}

float BlurredOutline::depth_m(FieldPoint point) const {
  const float x = point.x_m, y = std::abs(point.y_m);
  switch (outline_) {
    case PatchOutline::kCircle:
      return (1.0f - std::hypot(x / half_length_m_, y / half_width_m_)) * std::min(half_length_m_, half_width_m_);
    case PatchOutline::kTriangle:
      return std::min(2.0f / 3.0f * half_length_m_ + x, nx_ * (reach_x_m_ - x) - ny_ * y);
    case PatchOutline::kSquare:
    case PatchOutline::kBar:
      break;
  }
  return std::min(half_length_m_ - std::abs(x), half_width_m_ - y);
}

}  // namespace touchline
