#include "hal/mock/renderer.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace touchline::hal::mock {
namespace {

static_assert(kMaxRobots + 1 <= 32, "a pixel's objects are the bits of a 32-bit mask");

// White is rendered at nine tenths of full scale; the rest is headroom for places near a lamp.
constexpr float kWhiteLevel = 0.9f;
// Relative variation of the floor's reflectance from pixel to pixel; paper and paint are uneven.
constexpr float kFloorGrain = 0.03f;
constexpr float kGreyPaper = 0.45f;

// Position of a sample relative to the middle of its pixel, in pixels.
struct SamplePlace {
  float u, v;
};
constexpr std::size_t kSamplesPerSide = 4;
// Each sample has its own square among 4 x 4, and in it its own column and row among 16, so edges along the pixel grid
// move in steps of 1/16 pixel. Opposite positions have opposite times, because otherwise edges of moving robots would
// seem displaced. Of all orders with these properties, this one has the smallest error for an edge in the worst
// direction.
constexpr auto kSamplePlaces = [] {
  constexpr std::array kColumnOrder{0, 2, 1, 3}, kRowOrder{3, 1, 2, 0};
  constexpr auto kSide = static_cast<float>(kSamplesPerSide);
  const auto at = [](std::size_t square, int order) {
    return (static_cast<float>(square) + (static_cast<float>(order) + 0.5f) / kSide) / kSide - 0.5f;
  };
  std::array<SamplePlace, kSamplesPerSide * kSamplesPerSide> places{};
  for (std::size_t i = 0; i < places.size(); ++i) {
    const std::size_t column = i % kSamplesPerSide, row = i / kSamplesPerSide;
    places[i] = {at(column, kColumnOrder[row]), at(row, kRowOrder[column])};
  }
  return places;
}();

// Times of the samples in sixteenths of the exposure. The order is optimized for moving edges: exchanging any two
// entries increases the error, for motions of up to two pixels per exposure.
constexpr std::array kSampleTimes{13, 5, 1, 6, 7, 12, 15, 11, 4, 0, 3, 8, 9, 14, 10, 2};
// Returns the time of a sample, 0 to 1.
float sample_time(int sample) {
  return (static_cast<float>(kSampleTimes[static_cast<std::size_t>(sample)]) + 0.5f) / 16.0f;
}

LinearRgb paint(const ArenaParameters& parameters, const std::string& name) {
  const Paint* found = find_paint(parameters, name);
  return found == nullptr ? LinearRgb{} : reflectance(found->rgb);
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
      half_side_(static_cast<float>(0.5 * parameters.robot_side_m)),
      robot_height_(static_cast<float>(parameters.robot_height_m)),
      ball_radius_(static_cast<float>(parameters.ball_radius_m)),
      white_level_(kWhiteLevel * static_cast<float>(parameters.light.exposure * kLinearScale)),
      body_(reflectance(parameters.body_rgb)),
      ball_(paint(parameters, parameters.ball_color)),
      line_(reflectance(parameters.field.line_rgb)),
      ground_(reflectance(parameters.field.floor_rgb)),
      outside_(reflectance(parameters.field.outside_rgb)),
      rays_(width_ * height_),
      vignette_(width_ * height_),
      floor_(3 * width_ * height_),
      picture_(3 * width_ * height_),
      dark_(3 * width_ * height_),
      object_mask_(width_ * height_),
      ball_beams_(lighting_.lamps()) {
  covered_pixels_.reserve(width_ * height_);
  for (std::size_t i = 0; i < 3; ++i) eye_[i] = static_cast<float>(lens_.position_m()[i]);
  for (const ArenaRobot& robot : parameters_.robot) {
    Appearance appearance;
    for (std::size_t i = 0; i < parameters_.patch.size(); ++i) {
      const PaintedPatch& painted = parameters_.patch[i];
      const std::string& team = robot.team == Side::kOwn ? parameters_.own_color : parameters_.opponent_color;
      appearance.patches.push_back({painted.shape, static_cast<float>(painted.x_m), static_cast<float>(painted.y_m),
                                    static_cast<float>(painted.length_m), static_cast<float>(painted.width_m),
                                    paint(parameters_, i == 0 ? team : robot.colors[i - 1])});
    }
    appearances_.push_back(appearance);
  }
  const double half_diagonal = 0.5 * std::hypot(static_cast<double>(width_), static_cast<double>(height_));
  for (std::size_t row = 0; row < height_; ++row) {
    for (std::size_t column = 0; column < width_; ++column) {
      const auto u = static_cast<double>(column), v = static_cast<double>(row);
      const Vec3 direction = lens_.unproject(u, v);
      // A ray that does not descend is bent down to hit the floor far away; walls of the hall are not simulated.
      const double down = std::max(-direction[2], 0.05);
      const std::size_t index = row * width_ + column;
      rays_[index] = {static_cast<float>(direction[0] / down), static_cast<float>(direction[1] / down)};
      const double off =
          std::hypot(u - 0.5 * static_cast<double>(width_ - 1), v - 0.5 * static_cast<double>(height_ - 1));
      vignette_[index] =
          static_cast<float>(1.0 - parameters_.camera.vignetting * (off / half_diagonal) * (off / half_diagonal));
    }
  }
  render_floor_once(floor);
}

LinearRgb Renderer::floor_color(float x_m, float y_m, Floor floor) const {
  if (floor == Floor::kGreyPaper) return {kGreyPaper, kGreyPaper, kGreyPaper};
  const ArenaField& field = parameters_.field;
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

void Renderer::render_floor_once(Floor floor) {
  for (std::size_t row = 0; row < height_; ++row) {
    for (std::size_t column = 0; column < width_; ++column) {
      const std::size_t index = row * width_ + column;
      const Ray middle = rays_[index];
      const Ray right = rays_[column + 1 < width_ ? index + 1 : index - 1];
      const Ray below = rays_[row + 1 < height_ ? index + width_ : index - width_];
      const float sign_u = column + 1 < width_ ? 1.0f : -1.0f, sign_v = row + 1 < height_ ? 1.0f : -1.0f;
      LinearRgb sum{};
      for (int sample = 0; sample < kSamples; ++sample) {
        const SamplePlace& place = kSamplePlaces[static_cast<std::size_t>(sample)];
        const float du = sign_u * place.u, dv = sign_v * place.v;
        const float x = middle.x + du * (right.x - middle.x) + dv * (below.x - middle.x);
        const float y = middle.y + du * (right.y - middle.y) + dv * (below.y - middle.y);
        const LinearRgb color = floor_color(eye_[0] + eye_[2] * x, eye_[1] + eye_[2] * y, floor);
        for (std::size_t i = 0; i < 3; ++i) sum[i] += color[i];
      }
      const float light = lighting_.irradiance(eye_[0] + eye_[2] * middle.x, eye_[1] + eye_[2] * middle.y, 0.0f);
      const float factor = light * (1.0f + kFloorGrain * grain(index)) / static_cast<float>(kSamples);
      for (float& value : sum) value *= factor;
      store_pixel(index, sum);
    }
  }
  floor_ = picture_;
}

void Renderer::store_pixel(std::size_t index, const LinearRgb& light) {
  const float factor = white_level_ * vignette_[index];
  for (std::size_t i = 0; i < 3; ++i) {
    const float value = std::clamp(light[i] * factor + 0.5f, 0.0f, static_cast<float>(kLinearScale));
    picture_[3 * index + i] = static_cast<std::uint16_t>(value);
  }
}

std::span<const std::uint16_t> Renderer::render(const Snapshot& begin, const Snapshot& end, const RowTiming& rows,
                                                std::uint32_t hidden) {
  rows_ = rows;
  for (const std::uint32_t index : covered_pixels_) {
    std::copy_n(&floor_[std::size_t{3} * index], 3, &picture_[std::size_t{3} * index]);
  }
  covered_pixels_.clear();
  objects_.clear();
  const std::size_t robots = std::min(begin.robots.size(), appearances_.size());
  for (std::size_t i = 0; i < robots; ++i) {
    if ((hidden >> i & 1U) != 0) continue;
    add_object(&appearances_[i], begin.robots[i], end.robots[i], half_side_ * 1.4143f, robot_height_);
  }
  add_object(nullptr, begin.ball, end.ball, ball_radius_, 2.0f * ball_radius_);
  for (std::size_t i = 0; i < ball_beams_.size(); ++i) {
    ball_beams_[i] =
        lighting_.beam(i, static_cast<float>(begin.ball.x_m), static_cast<float>(begin.ball.y_m), ball_radius_);
  }
  for (const std::uint32_t index : covered_pixels_) {
    render_pixel(index, object_mask_[index]);
    object_mask_[index] = 0;
  }
  return picture_;
}

void Renderer::add_object(const Appearance* appearance, const Placement& begin, const Placement& end, float radius_m,
                          float height_m) {
  const auto bit = static_cast<std::uint32_t>(1U << objects_.size());
  Object object;
  object.appearance = appearance;
  object.begin = begin;
  object.end = end;
  object.turn_rad = std::remainder(end.theta_rad - begin.theta_rad, 2.0 * std::numbers::pi);
  if (!objects_.push_back(object)) return;
  // Bounding box in the image of the cuboids around the object's first and last pose.
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
      if (object_mask_[index] == 0) covered_pixels_.push_back(static_cast<std::uint32_t>(index));
      object_mask_[index] |= bit;
    }
  }
}

void Renderer::move_to_row(Object& object, std::size_t row) const {
  const bool is_rolling = rows_.begin_per_row > 0.0f;
  const std::size_t timed_row = is_rolling ? row : 0;  // with a global shutter, all rows have the same poses
  if (object.row == timed_row) return;
  object.row = timed_row;
  const Placement &begin = object.begin, &end = object.end;
  for (int sample = 0; sample < kSamples; ++sample) {
    const auto t =
        static_cast<double>(static_cast<float>(timed_row) * rows_.begin_per_row + sample_time(sample) * rows_.exposure);
    const double theta = begin.theta_rad + t * object.turn_rad;
    object.at[static_cast<std::size_t>(sample)] = {static_cast<float>(begin.x_m + t * (end.x_m - begin.x_m)),
                                                   static_cast<float>(begin.y_m + t * (end.y_m - begin.y_m)),
                                                   static_cast<float>(std::cos(theta)),
                                                   static_cast<float>(std::sin(theta))};
  }
}

void Renderer::render_pixel(std::size_t index, std::uint32_t mask) {
  const std::size_t row = index / width_, column = index % width_;
  const Ray middle = rays_[index];
  const bool last_column = column + 1 == width_, last_row = row + 1 == height_;
  const Ray right = rays_[last_column ? index - 1 : index + 1];
  const Ray below = rays_[last_row ? index - width_ : index + width_];
  const float sign_u = last_column ? -1.0f : 1.0f, sign_v = last_row ? -1.0f : 1.0f;
  const float drop = eye_[2] - robot_height_;
  const float top_light = lighting_.irradiance(eye_[0] + drop * middle.x, eye_[1] + drop * middle.y, robot_height_);
  for (std::uint32_t left = mask; left != 0; left &= left - 1) {
    move_to_row(objects_[static_cast<std::size_t>(__builtin_ctz(left))], row);
  }
  LinearRgb sum{};
  int floor_samples = 0;
  for (int sample = 0; sample < kSamples; ++sample) {
    const SamplePlace& place = kSamplePlaces[static_cast<std::size_t>(sample)];
    const float du = sign_u * place.u, dv = sign_v * place.v;
    const Ray ray{middle.x + du * (right.x - middle.x) + dv * (below.x - middle.x),
                  middle.y + du * (right.y - middle.y) + dv * (below.y - middle.y)};
    Hit hit;
    for (std::uint32_t left = mask; left != 0; left &= left - 1) {
      const Object& object = objects_[static_cast<std::size_t>(__builtin_ctz(left))];
      if (object.appearance != nullptr) {
        intersect_robot(object, sample, ray, top_light, hit);
      } else {
        intersect_ball(object, sample, ray, hit);
      }
    }
    if (hit.height_m < 0.0f) {
      ++floor_samples;
      continue;
    }
    for (std::size_t i = 0; i < 3; ++i) sum[i] += hit.color[i];
  }
  if (floor_samples == kSamples) return;
  for (float& value : sum) value /= static_cast<float>(kSamples);
  if (floor_samples > 0) {
    const float part =
        static_cast<float>(floor_samples) / (static_cast<float>(kSamples) * white_level_ * vignette_[index]);
    for (std::size_t i = 0; i < 3; ++i) sum[i] += part * static_cast<float>(floor_[3 * index + i]);
  }
  store_pixel(index, sum);
}

}  // namespace touchline::hal::mock
