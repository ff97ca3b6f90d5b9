#include "core/marker/ball_appearance.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include "core/fixed_vector.h"

namespace touchline {
namespace {

// Radius of the largest disk in samples, and half the size of the window: the seed is somewhere on the ball, and the
// ring is around it.
constexpr float kMostSamples = 6.0f;
constexpr int kReach = 16;
constexpr std::size_t kSide = 2 * kReach + 1;
// The ring leaves out the pixels that ball and floor share (blur, shared chroma).
constexpr float kRingGap_px = 1.2f, kRingWidth = 0.35f, kMinRingWidth = 1.5f;
// The patches of a robot are within this radius around another one of its patches.
constexpr float kSurroundings = 2.4f;
// Part of the disk's radius that its color is from.
constexpr float kCore = 0.6f;
// Weight of a pixel of the ball's color in the ring against one in the disk.
constexpr float kRingWeight = 0.7f;
// Samples of the floor lie on a circle of this radius, relative to the ball's, around the seed.
constexpr std::size_t kFloorSamples = 8;
constexpr float kFloorRadius = 2.4f;
// Largest deviation of the hue: 20 degrees (orange and yellow are 35 apart); more towards the next primary color: up to
// 8 degrees beyond it, but not more than 25 degrees. For a color without a hue, a relative deviation.
constexpr float kHueTolerance_rad = 0.35f, kPastPrimary_rad = 0.14f, kMostMore_rad = 0.44f, kColorTolerance = 0.36f;
constexpr float kPixelNoise_levels = 5.0f;
// A pixel with less of the ball's saturation, or less than this way from floor to ball, is not the ball.
constexpr float kMinSaturation = 0.3f, kMinContrast = 0.3f;
// Below this distance between ball and floor in levels, noise decides.
constexpr float kMinFloorDistance = 15.0f;
// Relative saturation below which a color has no hue: white, grey, black.
constexpr float kNoHue = 0.12f;
// Saturation of a robot's patch, relative to that of the ball.
constexpr float kColorful = 0.5f;

using Rgb = std::array<float, 3>;

// Axes of the plane of colors without their white part: towards red, and perpendicular to it.
constexpr Rgb kRed{0.8164966f, -0.4082483f, -0.4082483f}, kGreenToBlue{0.0f, 0.7071068f, -0.7071068f};

float dot(const Rgb& a, const Rgb& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Rgb minus(const Rgb& a, const Rgb& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
// The part of a color that white light does not have.
Rgb chroma_of(const Rgb& rgb) {
  const float mean = (rgb[0] + rgb[1] + rgb[2]) / 3.0f;
  return {rgb[0] - mean, rgb[1] - mean, rgb[2] - mean};
}

// Index of a row or column, which is relative to the middle.
std::size_t index(int i) {
  const int from_first = i + kReach;
  return static_cast<std::size_t>(from_first);
}

// One bit per sample.
class Samples {
 public:
  void set(int column, int row) { rows_[index(row)] |= std::uint64_t{1} << index(column); }
  // Number of samples at most `reach` rows from the middle whose columns are in a row's mask, about (column, row).
  template <class Masks>
  [[nodiscard]] int count(const Masks& masks, int column, int row) const {
    int sum = 0;
    for (int dv = -masks.reach; dv <= masks.reach; ++dv) {
      if (row + dv < -kReach || row + dv > kReach) continue;
      sum += std::popcount(rows_[index(row + dv)] & masks.at(dv, column));
    }
    return sum;
  }
  // The samples in a mask about (column, row), and those between them both in their row and in their column.
  template <class Masks>
  [[nodiscard]] Samples without_holes(const Masks& masks, int column, int row) const {
    Samples out;
    std::array<std::uint64_t, kSide> below{};  // or in it
    const int first = std::max(-kReach, row - masks.reach), last = std::min(kReach, row + masks.reach);
    std::uint64_t seen = 0;
    for (int r = last; r >= first; --r) below[index(r)] = seen |= rows_[index(r)] & masks.at(r - row, column);
    seen = 0;
    for (int r = first; r <= last; ++r) {
      const std::uint64_t bits = rows_[index(r)] & masks.at(r - row, column);
      seen |= bits;
      const std::uint64_t within = bits == 0 ? 0 : (std::bit_floor(bits) << 1u) - (bits & (~bits + 1));
      out.rows_[index(r)] = bits | (within & seen & below[index(r)] & masks.at(r - row, column));
    }
    return out;
  }
  [[nodiscard]] std::uint64_t row(int number) const { return rows_[index(number)]; }

 private:
  std::array<std::uint64_t, kSide> rows_{};
};

// Samples whose distance from a point is in [inner, outer).
struct Ring {
  Ring(float inner, float outer) : reach(std::min(kReach, static_cast<int>(std::ceil(outer)) - 1)) {
    for (int dv = -reach; dv <= reach; ++dv) {
      for (int du = -reach; du <= reach; ++du) {
        const float square = static_cast<float>(du * du + dv * dv);
        if (square < inner * inner || square >= outer * outer) continue;
        rows[index(dv)] |= std::uint64_t{1} << index(du);
        ++count;
      }
    }
  }
  [[nodiscard]] std::uint64_t at(int dv, int column) const {
    const std::uint64_t mask = rows[index(dv)];
    return column >= 0 ? mask << static_cast<unsigned>(column) : mask >> static_cast<unsigned>(-column);
  }
  int reach = 0, count = 0;
  std::array<std::uint64_t, kSide> rows{};
};

// Tells the ball's color from others.
class BallColor {
 public:
  BallColor(const Rgb& ball, const Rgb& floor) : ball_(ball), floor_(floor), way_(minus(ball, floor)) {
    way_ = {way_[0] / dot(minus(ball, floor), minus(ball, floor)),
            way_[1] / dot(minus(ball, floor), minus(ball, floor)),
            way_[2] / dot(minus(ball, floor), minus(ball, floor))};
    const Rgb chroma = chroma_of(ball);
    saturation_ = std::sqrt(dot(chroma, chroma));
    has_hue_ = saturation_ > kNoHue * std::sqrt(dot(ball, ball));
    if (!has_hue_) {
      // The color itself takes the place of the hue.
      saturation_ = std::sqrt(dot(ball, ball));
      for (std::size_t c = 0; c < 3; ++c) hue_[c] = ball[c] / saturation_;
      return;
    }
    // Cameras that increase contrast clip weak channels of the dark side to zero, which moves its hue to a primary.
    const float hue = std::atan2(dot(chroma, kGreenToBlue), dot(chroma, kRed));
    const float beyond_primary = std::remainder(hue, 2.0f * std::numbers::pi_v<float> / 3.0f);
    const float more = std::clamp(std::abs(beyond_primary) + kPastPrimary_rad - kHueTolerance_rad, 0.0f, kMostMore_rad);
    const float middle = hue - std::copysign(0.5f * more, beyond_primary);
    for (std::size_t c = 0; c < 3; ++c) {
      hue_[c] = std::cos(middle) * kRed[c] + std::sin(middle) * kGreenToBlue[c];
    }
    tolerance_ = std::tan(kHueTolerance_rad + 0.5f * more);
  }
  [[nodiscard]] bool differs_from_floor() const {
    const Rgb way = minus(ball_, floor_);
    return dot(way, way) > kMinFloorDistance * kMinFloorDistance;
  }
  [[nodiscard]] bool is_ball(const Rgb& rgb) const {
    if (dot(minus(rgb, floor_), way_) < kMinContrast) return false;
    const Rgb color = has_hue_ ? chroma_of(rgb) : rgb;
    const float along = dot(color, hue_), across2 = std::max(0.0f, dot(color, color) - along * along);
    const float allowed = kPixelNoise_levels + tolerance_ * along;
    return along > kMinSaturation * saturation_ && across2 < allowed * allowed;
  }
  [[nodiscard]] bool is_other_color(const Rgb& rgb) const {
    const Rgb chroma = chroma_of(rgb), of_floor = chroma_of(floor_), change = minus(chroma, of_floor);
    const float least = kColorful * (has_hue_ ? saturation_ : kNoHue * saturation_) + kPixelNoise_levels;
    return dot(chroma, chroma) > least * least && dot(change, change) > least * least;
  }

 private:
  Rgb ball_, floor_, way_, hue_{};
  float saturation_ = 0, tolerance_ = kColorTolerance;
  bool has_hue_ = false;
};

Rgb rgb_at(const Frame& frame, int u, int v, ColorSpace space) {
  const auto pixel = pixel_at(frame, static_cast<std::size_t>(u), static_cast<std::size_t>(v));
  return to_rgb({static_cast<float>(pixel[0]), static_cast<float>(pixel[1]), static_cast<float>(pixel[2])}, space);
}

bool is_in(const Frame& frame, int u, int v) { return u >= 0 && v >= 0 && u < frame.width_px && v < frame.height_px; }

// Finds the median color of the floor around the ball.
bool look_at_floor(const Frame& frame, int u, int v, float radius_px, Rgb& out) {
  std::array<FixedVector<float, kFloorSamples>, 3> values;
  const ColorSpace space = color_space(frame.format);
  for (std::size_t i = 0; i < kFloorSamples; ++i) {
    const float angle = 2.0f * std::numbers::pi_v<float> * static_cast<float>(i) / static_cast<float>(kFloorSamples);
    const int column = u + static_cast<int>(std::lround((kFloorRadius * radius_px + 1.0f) * std::cos(angle)));
    const int row = v + static_cast<int>(std::lround((kFloorRadius * radius_px + 1.0f) * std::sin(angle)));
    if (!is_in(frame, column, row)) continue;
    const Rgb rgb = rgb_at(frame, column, row, space);
    for (std::size_t c = 0; c < 3; ++c) values[c].push_back(rgb[c]);
  }
  if (values[0].size() < kFloorSamples / 2) return false;
  for (std::size_t c = 0; c < 3; ++c) {
    float* const middle = values[c].begin() + values[c].size() / 2;
    std::nth_element(values[c].begin(), middle, values[c].end());
    out[c] = *middle;
  }
  return true;
}

// Pixel to coordinates in half sides of a robot's top.
struct TopTest {
  TopTest() = default;
  explicit TopTest(const RobotTop& top) : center(top.center) {
    const PixelPoint &x = top.half_side[0], &y = top.half_side[1];
    const float determinant = x.u_px * y.v_px - y.u_px * x.v_px;
    if (std::abs(determinant) < 1e-6f) return;
    inverse = {y.v_px / determinant, -y.u_px / determinant, -x.v_px / determinant, x.u_px / determinant};
  }
  [[nodiscard]] bool covers(float u, float v) const {
    const float du = u - center.u_px, dv = v - center.v_px;
    return std::abs(inverse[0] * du + inverse[1] * dv) < 1.0f && std::abs(inverse[2] * du + inverse[3] * dv) < 1.0f;
  }
  PixelPoint center;
  std::array<float, 4> inverse{1e9f, 1e9f, 1e9f, 1e9f};
};

}  // namespace

bool look_at_ball(const Frame& frame, PixelPoint seed, float radius_px, const std::array<float, 3>& rgb,
                  std::span<const RobotTop> robots, BallAppearance& out) {
  // Also false for NaN.
  if (!(radius_px >= kMinAppearanceRadius_px && radius_px < 65536.0f)) return false;
  if (!(seed.u_px >= 0.0f && seed.v_px >= 0.0f && seed.u_px < 65536.0f && seed.v_px < 65536.0f)) return false;
  const int seed_u = static_cast<int>(std::lround(seed.u_px)), seed_v = static_cast<int>(std::lround(seed.v_px));
  if (!is_in(frame, seed_u, seed_v)) return false;
  Rgb floor{};
  if (!look_at_floor(frame, seed_u, seed_v, radius_px, floor)) return false;
  const BallColor color(rgb, floor);
  if (!color.differs_from_floor()) return false;

  const int step = static_cast<int>(std::ceil(radius_px / kMostSamples));
  const float radius = radius_px / static_cast<float>(step);
  const float inner = radius + std::max(1.0f, kRingGap_px / static_cast<float>(step));
  const float outer = std::max(kSurroundings * radius, inner + kMinRingWidth);
  const Ring disk(0.0f, radius), surroundings(inner, outer),
      ring(inner, inner + std::max(kMinRingWidth, kRingWidth * radius));
  const int search = static_cast<int>(radius), reach = std::min(kReach, search + surroundings.reach);
  FixedVector<TopTest, kMaxRobots> tops;
  for (const RobotTop& robot : robots) tops.push_back(TopTest(robot));

  // The surroundings are wide: every second pixel and row of them is enough.
  const int dense = search + ring.reach;
  const ColorSpace space = color_space(frame.format);
  Samples ball, visible, coarse, colorful;
  for (int row = -reach; row <= reach; ++row) {
    for (int column = -reach; column <= reach; ++column) {
      const bool is_coarse = row % 2 == 0 && column % 2 == 0;
      if (!is_coarse && row * row + column * column > dense * dense) continue;
      const int u = seed_u + column * step, v = seed_v + row * step;
      if (!is_in(frame, u, v)) continue;
      const bool hidden = std::any_of(tops.begin(), tops.end(), [&](const TopTest& top) {
        return top.covers(static_cast<float>(u), static_cast<float>(v));
      });
      if (hidden) continue;
      visible.set(column, row);
      if (is_coarse) coarse.set(column, row);
      const Rgb value = rgb_at(frame, u, v, space);
      if (color.is_ball(value)) {
        ball.set(column, row);
      } else if (is_coarse && color.is_other_color(value)) {
        colorful.set(column, row);
      }
    }
  }

  // The best disk; of equally good ones, their mean.
  float best = -1e9f, sum_u = 0, sum_v = 0, equal = 0;
  for (int row = -search; row <= search; ++row) {
    for (int column = -search; column <= search; ++column) {
      if (column * column + row * row > search * search) continue;
      const int inside = ball.count(disk, column, row);
      if (static_cast<float>(inside) < best) continue;
      const float value = static_cast<float>(inside) - kRingWeight * static_cast<float>(ball.count(ring, column, row));
      if (value > best) {
        best = value;
        sum_u = sum_v = equal = 0;
      }
      if (value == best) {
        sum_u += static_cast<float>(column);
        sum_v += static_cast<float>(row);
        equal += 1;
      }
    }
  }
  const int at_u = static_cast<int>(std::lround(sum_u / equal)), at_v = static_cast<int>(std::lround(sum_v / equal));
  const auto inside = static_cast<float>(ball.count(disk, at_u, at_v));
  // A lamp's reflection has no color, but the ball's color around it.
  const auto with_reflections = static_cast<float>(ball.without_holes(disk, at_u, at_v).count(disk, at_u, at_v));
  const auto shown = static_cast<float>(visible.count(disk, at_u, at_v));
  const auto around = std::max(1.0f, static_cast<float>(visible.count(ring, at_u, at_v)));
  if (inside < 1.0f) return false;
  out.visible = shown / static_cast<float>(disk.count);
  out.filled = std::min(1.0f, with_reflections / shown);
  out.overflow = static_cast<float>(ball.count(ring, at_u, at_v)) / around;
  out.colorful = static_cast<float>(colorful.count(surroundings, at_u, at_v)) /
                 std::max(1.0f, static_cast<float>(coarse.count(surroundings, at_u, at_v)));
  out.area_px = with_reflections * static_cast<float>(step * step);

  float mean_u = 0, mean_v = 0;
  for (int row = std::max(-kReach, at_v - disk.reach); row <= std::min(kReach, at_v + disk.reach); ++row) {
    for (std::uint64_t bits = ball.row(row) & disk.at(row - at_v, at_u); bits != 0; bits &= bits - 1) {
      mean_u += static_cast<float>(std::countr_zero(bits) - kReach) / inside;
      mean_v += static_cast<float>(row) / inside;
    }
  }
  out.center = {static_cast<float>(seed_u) + static_cast<float>(step) * mean_u,
                static_cast<float>(seed_v) + static_cast<float>(step) * mean_v};
  // The rim is darker than the patch that the typical value is from.
  const Ring core(0.0f, std::max(1.0f, kCore * radius));
  const Ring& middle = ball.count(core, at_u, at_v) > 0 ? core : disk;
  const auto samples = static_cast<float>(ball.count(middle, at_u, at_v));
  out.rgb = {};
  for (int row = std::max(-kReach, at_v - middle.reach); row <= std::min(kReach, at_v + middle.reach); ++row) {
    for (std::uint64_t bits = ball.row(row) & middle.at(row - at_v, at_u); bits != 0; bits &= bits - 1) {
      const int column = std::countr_zero(bits) - kReach;
      const Rgb value = rgb_at(frame, seed_u + column * step, seed_v + row * step, space);
      for (std::size_t c = 0; c < 3; ++c) out.rgb[c] += value[c] / samples;
    }
  }
  return true;
}

}  // namespace touchline
