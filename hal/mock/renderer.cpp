#include "hal/mock/renderer.h"

#include <algorithm>
#include <cmath>

namespace touchline::hal::mock {
namespace {

static_assert(kMaxRobots + 1 <= 32, "a pixel's things are bits of one word");

// White at nine tenths of full scale leaves room for lamps that are nearer than average.
constexpr float kWhiteLevel = 0.9f;
// Vertical faces see half of the sky and little of the lamps above.
constexpr float kSideLight = 0.45f;
// Paper and paint are not even: part by which the floor's reflectance varies from pixel to pixel.
constexpr float kFloorGrain = 0.03f;
constexpr float kGreyPaper = 0.45f;
constexpr float kGloss = 0.35f;
constexpr float kGlossPower = 60.0f;

float sub_pixel(int i) { return (static_cast<float>(i) + 0.5f) / 4.0f - 0.5f; }

// Neighboring rays are far apart in time, so that a blurred edge is smooth.
float instant_of(int ray) { return (static_cast<float>((ray * 7) % 16) + 0.5f) / 16.0f; }

Linear paint(const ArenaParameters& parameters, const std::string& name) {
  const Paint* found = find_paint(parameters, name);
  return found == nullptr ? Linear{} : reflectance(found->rgb);
}

float grain(std::size_t index) {
  std::uint64_t z = (index + 1) * 0x9E3779B97F4A7C15U;
  z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9U;
  return static_cast<float>(static_cast<double>(z >> 40U) * 0x1p-23 - 1.0);
}

}  // namespace

Renderer::Renderer(const ArenaParameters& parameters, std::uint16_t width_px, std::uint16_t height_px, Floor floor)
    : parameters_(parameters),
      width_(width_px),
      height_(height_px),
      lens_(parameters.camera),
      lighting_(parameters.light, parameters.field),
      side_half_(static_cast<float>(0.5 * parameters.robot_side_m)),
      robot_height_(static_cast<float>(parameters.robot_height_m)),
      ball_radius_(static_cast<float>(parameters.ball_radius_m)),
      scale_(kWhiteLevel * static_cast<float>(parameters.light.exposure * kLinearScale)),
      body_(reflectance(parameters.body_rgb)),
      ball_(paint(parameters, parameters.ball_color)),
      line_(reflectance(parameters.field.line_rgb)),
      ground_(reflectance(parameters.field.floor_rgb)),
      outside_(reflectance(parameters.field.outside_rgb)),
      sights_(width_ * height_),
      vignette_(width_ * height_),
      floor_(3 * width_ * height_),
      picture_(3 * width_ * height_),
      dark_(3 * width_ * height_),
      covered_by_(width_ * height_),
      ball_beams_(lighting_.lamps()) {
  covered_.reserve(width_ * height_);
  for (std::size_t i = 0; i < 3; ++i) eye_[i] = static_cast<float>(lens_.position_m()[i]);
  for (const ArenaRobot& robot : parameters_.robot) {
    Look look;
    for (std::size_t i = 0; i < parameters_.patch.size(); ++i) {
      const PaintedPatch& painted = parameters_.patch[i];
      const std::string& team = robot.team == Side::kOwn ? parameters_.own_color : parameters_.opponent_color;
      look.patches.push_back({painted.shape, static_cast<float>(painted.x_m), static_cast<float>(painted.y_m),
                              static_cast<float>(painted.length_m), static_cast<float>(painted.width_m),
                              paint(parameters_, i == 0 ? team : robot.colors[i - 1])});
    }
    looks_.push_back(look);
  }
  const double half_diagonal = 0.5 * std::hypot(static_cast<double>(width_), static_cast<double>(height_));
  for (std::size_t row = 0; row < height_; ++row) {
    for (std::size_t column = 0; column < width_; ++column) {
      const auto u = static_cast<double>(column), v = static_cast<double>(row);
      const Vec3 direction = lens_.direction(u, v);
      // A line of sight that does not go down would see the hall's walls; it sees floor far away instead.
      const double down = std::max(-direction[2], 0.05);
      const std::size_t index = row * width_ + column;
      sights_[index] = {static_cast<float>(direction[0] / down), static_cast<float>(direction[1] / down)};
      const double off =
          std::hypot(u - 0.5 * static_cast<double>(width_ - 1), v - 0.5 * static_cast<double>(height_ - 1));
      vignette_[index] =
          static_cast<float>(1.0 - parameters_.camera.vignetting * (off / half_diagonal) * (off / half_diagonal));
    }
  }
  draw_floor(floor);
}

Linear Renderer::floor_color(float x_m, float y_m, Floor floor) const {
  if (floor == Floor::kGreyPaper) return {kGreyPaper, kGreyPaper, kGreyPaper};
  const FieldParameters& field = parameters_.field;
  const float x = std::abs(x_m), y = std::abs(y_m);
  const auto half_length = static_cast<float>(0.5 * field.length_m),
             half_width = static_cast<float>(0.5 * field.width_m);
  const auto half_line = static_cast<float>(0.5 * field.line_m), border = static_cast<float>(field.border_m);
  const auto goal = static_cast<float>(0.5 * field.goal_width_m), depth = static_cast<float>(field.goal_depth_m);
  if (x > half_length || y > half_width) {
    const bool in_goal = y < goal && x < half_length + depth;
    if (in_goal) return x < half_length + 2.0f * half_line ? line_ : ground_;
    const bool around_goal = y < goal + border && x < half_length + depth + border;
    const bool on_border = x < half_length + border && y < half_width + border;
    return on_border || around_goal ? line_ : outside_;
  }
  const auto corner = static_cast<float>(field.corner_m);
  if (half_length - x + half_width - y < corner) return line_;
  const auto radius = static_cast<float>(field.circle_radius_m);
  const bool on_line = x < half_line || std::abs(std::hypot(x, y) - radius) < half_line;
  return on_line ? line_ : ground_;
}

void Renderer::draw_floor(Floor floor) {
  for (std::size_t row = 0; row < height_; ++row) {
    for (std::size_t column = 0; column < width_; ++column) {
      const std::size_t index = row * width_ + column;
      const Sight middle = sights_[index];
      const Sight right = sights_[column + 1 < width_ ? index + 1 : index - 1];
      const Sight below = sights_[row + 1 < height_ ? index + width_ : index - width_];
      const float sign_u = column + 1 < width_ ? 1.0f : -1.0f, sign_v = row + 1 < height_ ? 1.0f : -1.0f;
      Linear sum{};
      for (int ray = 0; ray < kRays; ++ray) {
        const float du = sign_u * sub_pixel(ray % kRaysAside), dv = sign_v * sub_pixel(ray / kRaysAside);
        const float x = middle.x + du * (right.x - middle.x) + dv * (below.x - middle.x);
        const float y = middle.y + du * (right.y - middle.y) + dv * (below.y - middle.y);
        const Linear color = floor_color(eye_[0] + eye_[2] * x, eye_[1] + eye_[2] * y, floor);
        for (std::size_t i = 0; i < 3; ++i) sum[i] += color[i];
      }
      const float light = lighting_.on_level(eye_[0] + eye_[2] * middle.x, eye_[1] + eye_[2] * middle.y, 0.0f);
      const float factor = light * (1.0f + kFloorGrain * grain(index)) / static_cast<float>(kRays);
      for (float& value : sum) value *= factor;
      store(index, sum);
    }
  }
  floor_ = picture_;
}

void Renderer::store(std::size_t index, const Linear& light) {
  const float factor = scale_ * vignette_[index];
  for (std::size_t i = 0; i < 3; ++i) {
    const float value = std::clamp(light[i] * factor + 0.5f, 0.0f, static_cast<float>(kLinearScale));
    picture_[3 * index + i] = static_cast<std::uint16_t>(value);
  }
}

std::span<const std::uint16_t> Renderer::render(const Snapshot& begin, const Snapshot& end) {
  for (const std::uint32_t index : covered_) {
    std::copy_n(&floor_[std::size_t{3} * index], 3, &picture_[std::size_t{3} * index]);
  }
  covered_.clear();
  things_.clear();
  const std::size_t robots = std::min(begin.robots.size(), looks_.size());
  for (std::size_t i = 0; i < robots; ++i) {
    add(&looks_[i], begin.robots[i], end.robots[i], side_half_ * 1.4143f, robot_height_);
  }
  add(nullptr, begin.ball, end.ball, ball_radius_, 2.0f * ball_radius_);
  for (std::size_t i = 0; i < ball_beams_.size(); ++i) {
    ball_beams_[i] =
        lighting_.beam(i, static_cast<float>(begin.ball.x_m), static_cast<float>(begin.ball.y_m), ball_radius_);
  }
  for (const std::uint32_t index : covered_) {
    draw_pixel(index, covered_by_[index]);
    covered_by_[index] = 0;
  }
  return picture_;
}

void Renderer::add(const Look* look, const Placement& begin, const Placement& end, float radius_m, float height_m) {
  const auto bit = static_cast<std::uint32_t>(1U << things_.size());
  Thing thing;
  thing.look = look;
  const double turn = std::remainder(end.theta_rad - begin.theta_rad, 2.0 * std::numbers::pi);
  for (int ray = 0; ray < kRays; ++ray) {
    const auto t = static_cast<double>(instant_of(ray));
    const double theta = begin.theta_rad + t * turn;
    thing.at[static_cast<std::size_t>(ray)] = {static_cast<float>(begin.x_m + t * (end.x_m - begin.x_m)),
                                               static_cast<float>(begin.y_m + t * (end.y_m - begin.y_m)),
                                               static_cast<float>(std::cos(theta)),
                                               static_cast<float>(std::sin(theta))};
  }
  if (!things_.push_back(thing)) return;
  // The picture's box around the cuboid around the way of the thing.
  std::array<double, 4> box{1e9, 1e9, -1e9, -1e9};
  for (int corner = 0; corner < 16; ++corner) {
    const Placement& at = (corner & 8) != 0 ? end : begin;
    const auto side = [&](int mask) { return (corner & mask) != 0 ? radius_m : -radius_m; };
    const auto [u, v] = lens_.project({at.x_m + static_cast<double>(side(1)), at.y_m + static_cast<double>(side(2)),
                                       (corner & 4) != 0 ? static_cast<double>(height_m) : 0.0});
    box = {std::min(box[0], u), std::min(box[1], v), std::max(box[2], u), std::max(box[3], v)};
  }
  const int left = std::max(0, static_cast<int>(std::floor(box[0])) - 1);
  const int top = std::max(0, static_cast<int>(std::floor(box[1])) - 1);
  const int right = std::min(static_cast<int>(width_) - 1, static_cast<int>(std::ceil(box[2])) + 1);
  const int bottom = std::min(static_cast<int>(height_) - 1, static_cast<int>(std::ceil(box[3])) + 1);
  for (int row = top; row <= bottom; ++row) {
    for (int column = left; column <= right; ++column) {
      const std::size_t index = static_cast<std::size_t>(row) * width_ + static_cast<std::size_t>(column);
      if (covered_by_[index] == 0) covered_.push_back(static_cast<std::uint32_t>(index));
      covered_by_[index] |= bit;
    }
  }
}

void Renderer::draw_pixel(std::size_t index, std::uint32_t things) {
  const std::size_t row = index / width_, column = index % width_;
  const Sight middle = sights_[index];
  const bool last_column = column + 1 == width_, last_row = row + 1 == height_;
  const Sight right = sights_[last_column ? index - 1 : index + 1];
  const Sight below = sights_[last_row ? index - width_ : index + width_];
  const float sign_u = last_column ? -1.0f : 1.0f, sign_v = last_row ? -1.0f : 1.0f;
  const float drop = eye_[2] - robot_height_;
  const float top_light = lighting_.on_level(eye_[0] + drop * middle.x, eye_[1] + drop * middle.y, robot_height_);
  Linear sum{};
  int missed = 0;
  for (int ray = 0; ray < kRays; ++ray) {
    const float du = sign_u * sub_pixel(ray % kRaysAside), dv = sign_v * sub_pixel(ray / kRaysAside);
    const Sight sight{middle.x + du * (right.x - middle.x) + dv * (below.x - middle.x),
                      middle.y + du * (right.y - middle.y) + dv * (below.y - middle.y)};
    Hit hit;
    for (std::uint32_t left = things; left != 0; left &= left - 1) {
      const Thing& thing = things_[static_cast<std::size_t>(__builtin_ctz(left))];
      if (thing.look != nullptr) {
        hit_robot(thing, ray, sight, top_light, hit);
      } else {
        hit_ball(thing, ray, sight, hit);
      }
    }
    if (hit.height_m < 0.0f) {
      ++missed;
      continue;
    }
    for (std::size_t i = 0; i < 3; ++i) sum[i] += hit.color[i];
  }
  if (missed == kRays) return;
  for (float& value : sum) value /= static_cast<float>(kRays);
  if (missed > 0) {
    const float part = static_cast<float>(missed) / (static_cast<float>(kRays) * scale_ * vignette_[index]);
    for (std::size_t i = 0; i < 3; ++i) sum[i] += part * static_cast<float>(floor_[3 * index + i]);
  }
  store(index, sum);
}

void Renderer::hit_robot(const Thing& thing, int ray, Sight sight, float top_light, Hit& hit) const {
  if (hit.height_m >= robot_height_) return;
  const Turned& at = thing.at[static_cast<std::size_t>(ray)];
  const float drop = eye_[2] - robot_height_;
  const float dx = eye_[0] + drop * sight.x - at.x, dy = eye_[1] + drop * sight.y - at.y;
  const float x = at.cos * dx + at.sin * dy, y = -at.sin * dx + at.cos * dy;
  if (std::abs(x) <= side_half_ && std::abs(y) <= side_half_) {
    hit.height_m = robot_height_;
    const Linear* color = &body_;
    for (const Patch& patch : thing.look->patches) {
      const float px = x - patch.x, py = y - patch.y;
      bool inside = false;
      switch (patch.shape) {
        case PatchShape::kSquare:
          inside = std::abs(px) <= 0.5f * patch.length && std::abs(py) <= 0.5f * patch.width;
          break;
        case PatchShape::kTriangle: {
          // The centroid is a third of the height in front of the base.
          const float from_base = px + patch.length / 3.0f;
          inside = from_base >= 0.0f && std::abs(py) * patch.length <= 0.5f * patch.width * (patch.length - from_base);
          break;
        }
        case PatchShape::kCircle:
          inside = px * px + py * py <= 0.25f * patch.length * patch.length;
          break;
      }
      if (inside) color = &patch.color;
    }
    for (std::size_t i = 0; i < 3; ++i) hit.color[i] = (*color)[i] * top_light;
    return;
  }
  // From the plane of the top down to the floor: does the ray enter the footprint on its way?
  const float wx = robot_height_ * (at.cos * sight.x + at.sin * sight.y);
  const float wy = robot_height_ * (-at.sin * sight.x + at.cos * sight.y);
  float enter = 0.0f, leave = 1.0f;
  const auto slab = [&](float from, float way) {
    if (std::abs(way) < 1e-9f) {
      if (std::abs(from) > side_half_) leave = -1.0f;
      return;
    }
    const float a = (-side_half_ - from) / way, b = (side_half_ - from) / way;
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

void Renderer::hit_ball(const Thing& thing, int ray, Sight sight, Hit& hit) const {
  const Turned& at = thing.at[static_cast<std::size_t>(ray)];
  // |eye + s (x, y, -1) - center| = radius
  const std::array<float, 3> from{eye_[0] - at.x, eye_[1] - at.y, eye_[2] - ball_radius_};
  const float a = sight.x * sight.x + sight.y * sight.y + 1.0f;
  const float half_b = from[0] * sight.x + from[1] * sight.y - from[2];
  const float c = from[0] * from[0] + from[1] * from[1] + from[2] * from[2] - ball_radius_ * ball_radius_;
  const float root = half_b * half_b - a * c;
  if (root < 0.0f) return;
  const float s = (-half_b - std::sqrt(root)) / a;
  const float height = eye_[2] - s;
  if (height <= hit.height_m) return;
  hit.height_m = height;
  const std::array<float, 3> normal{(from[0] + s * sight.x) / ball_radius_, (from[1] + s * sight.y) / ball_radius_,
                                    (from[2] - s) / ball_radius_};
  float light = lighting_.ambient() * 0.5f * (1.0f + normal[2]), gloss = 0.0f;
  const float to_eye = 1.0f / std::sqrt(a);
  for (const Lighting::Beam& beam : ball_beams_) {
    const float cosine = normal[0] * beam.towards[0] + normal[1] * beam.towards[1] + normal[2] * beam.towards[2];
    if (cosine <= 0.0f) continue;
    light += beam.strength * cosine;
    // Blinn 1977: the highlight stands where the normal halves the angle between lamp and eye.
    const std::array<float, 3> half{beam.towards[0] - sight.x * to_eye, beam.towards[1] - sight.y * to_eye,
                                    beam.towards[2] + to_eye};
    const float norm = std::sqrt(half[0] * half[0] + half[1] * half[1] + half[2] * half[2]);
    const float along = (normal[0] * half[0] + normal[1] * half[1] + normal[2] * half[2]) / norm;
    if (along > 0.9f) gloss += kGloss * beam.strength * std::pow(along, kGlossPower);
  }
  for (std::size_t i = 0; i < 3; ++i) hit.color[i] = ball_[i] * light + gloss;
}

}  // namespace touchline::hal::mock
