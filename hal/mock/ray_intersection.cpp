// Intersection of viewing rays with robots and ball, and the light reflected at the intersection.
#include <algorithm>
#include <cmath>

#include "hal/mock/renderer.h"

namespace touchline::hal::mock {
namespace {

// Brightness of a robot's sides relative to its top: they get half of the ambient light and little from the lamps.
constexpr float kSideLight = 0.45f;
// Strength and exponent of the ball's specular highlight.
constexpr float kGloss = 0.35f;
constexpr float kGlossPower = 60.0f;

// Returns whether a patch covers the point x, y relative to its centroid, in the robot's frame.
bool contains(PatchShape shape, float x, float y, float length, float width) {
  switch (shape) {
    case PatchShape::kSquare:
      return std::abs(x) <= 0.5f * length && std::abs(y) <= 0.5f * width;
    case PatchShape::kTriangle: {
      // The centroid of a triangle lies a third of the height from the base.
      const float from_base = x + length / 3.0f;
      return from_base >= 0.0f && std::abs(y) * length <= 0.5f * width * (length - from_base);
    }
    case PatchShape::kCircle:
      return x * x + y * y <= 0.25f * length * length;
  }
  return false;
}

}  // namespace

void Renderer::intersect_robot(const Object& object, int sample, Ray ray, float top_light, Hit& hit) const {
  if (hit.height_m >= robot_height_) return;
  const PlanarPose& at = object.at[static_cast<std::size_t>(sample)];
  const float drop = eye_[2] - robot_height_;
  const float dx = eye_[0] + drop * ray.x - at.x, dy = eye_[1] + drop * ray.y - at.y;
  const float x = at.cos * dx + at.sin * dy, y = -at.sin * dx + at.cos * dy;
  if (std::abs(x) <= half_side_ && std::abs(y) <= half_side_) {
    hit.height_m = robot_height_;
    const LinearRgb* color = &body_;
    for (const RenderedPatch& patch : object.appearance->patches) {
      if (contains(patch.shape, x - patch.x, y - patch.y, patch.length, patch.width)) color = &patch.color;
    }
    for (std::size_t i = 0; i < 3; ++i) hit.color[i] = (*color)[i] * top_light;
    return;
  }
  // Slab test (Kay and Kajiya 1986): does the ray enter the footprint between the plane of the top and the floor?
  const float wx = robot_height_ * (at.cos * ray.x + at.sin * ray.y);
  const float wy = robot_height_ * (-at.sin * ray.x + at.cos * ray.y);
  float enter = 0.0f, leave = 1.0f;
  const auto slab = [&](float from, float way) {
    if (std::abs(way) < 1e-9f) {
      if (std::abs(from) > half_side_) leave = -1.0f;
      return;
    }
    const float a = (-half_side_ - from) / way, b = (half_side_ - from) / way;
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  };
  slab(x, wx);
  slab(y, wy);
  if (enter > leave) return;
  const float height = robot_height_ * (1.0f - enter);
  if (height <= hit.height_m) return;
  hit.height_m = height;
  for (std::size_t i = 0; i < 3; ++i) hit.color[i] = body_[i] * top_light * kSideLight;
}

void Renderer::intersect_ball(const Object& object, int sample, Ray ray, Hit& hit) const {
  const PlanarPose& at = object.at[static_cast<std::size_t>(sample)];
  // Solve |eye + s (x, y, -1) - center| = radius for s.
  const std::array<float, 3> from{eye_[0] - at.x, eye_[1] - at.y, eye_[2] - ball_radius_};
  const float a = ray.x * ray.x + ray.y * ray.y + 1.0f;
  const float half_b = from[0] * ray.x + from[1] * ray.y - from[2];
  const float c = from[0] * from[0] + from[1] * from[1] + from[2] * from[2] - ball_radius_ * ball_radius_;
  const float root = half_b * half_b - a * c;
  if (root < 0.0f) return;
  const float s = (-half_b - std::sqrt(root)) / a;
  const float height = eye_[2] - s;
  if (height <= hit.height_m) return;
  hit.height_m = height;
  const std::array<float, 3> normal{(from[0] + s * ray.x) / ball_radius_, (from[1] + s * ray.y) / ball_radius_,
                                    (from[2] - s) / ball_radius_};
  float light = lighting_.ambient() * 0.5f * (1.0f + normal[2]), gloss = 0.0f;
  const float to_eye = 1.0f / std::sqrt(a);
  for (const Lighting::Beam& beam : ball_beams_) {
    const float cosine = normal[0] * beam.towards[0] + normal[1] * beam.towards[1] + normal[2] * beam.towards[2];
    if (cosine <= 0.0f) continue;
    light += beam.strength * cosine;
    // Blinn 1977: the highlight depends on the angle between the normal and the half vector of lamp and eye.
    const std::array<float, 3> half{beam.towards[0] - ray.x * to_eye, beam.towards[1] - ray.y * to_eye,
                                    beam.towards[2] + to_eye};
    const float norm = std::sqrt(half[0] * half[0] + half[1] * half[1] + half[2] * half[2]);
    const float along = (normal[0] * half[0] + normal[1] * half[1] + normal[2] * half[2]) / norm;
    if (along > 0.9f) gloss += kGloss * beam.strength * std::pow(along, kGlossPower);
  }
  for (std::size_t i = 0; i < 3; ++i) hit.color[i] = ball_[i] * light + gloss;
}

}  // namespace touchline::hal::mock
