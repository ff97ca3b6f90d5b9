#include "core/marker/ball_appearance.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/fixed_vector.h"
#include "core/marker/ball_color.h"
#include "core/marker/ball_samples.h"
#include "core/marker/sampled_pixels.h"
#include "core/marker/simd4.h"

namespace touchline {
namespace {

using Rgb = BallColor::Rgb;

// Radius of the largest disk in samples. The seed may be any point of the ball. With this radius, disk and ring fit
// into the square of samples wherever the seed is.
constexpr float kMaxRadiusInSamples = 6.0f;
// The ring skips the pixels in which ball and floor mix (blur, shared chroma).
constexpr float kRingGap_px = 1.2f, kRingWidth = 0.35f, kMinRingWidth = 1.5f;
// Radius around a patch of a robot, relative to the ball's radius, within which the robot's other patches lie.
constexpr float kSurroundings = 2.4f;
// The color is measured within this part of the disk's radius.
constexpr float kCore = 0.6f;
// Radius around the disk's center in which the shape is measured.
constexpr float kShapeSampleRadius = 1.5f;
// Weight of a pixel of the ball's color in the ring, relative to the weight of a pixel of this color in the disk.
constexpr float kRingWeight = 0.7f;
// Weight of a visible pixel of another color in the disk of a ball that a robot may hide.
constexpr float kUnfilledWeight = 0.5f;
// Samples of the floor lie on a circle of this radius, relative to the ball's, around the seed.
constexpr float kFloorRadius = 2.4f;
constexpr float kDiagonal = 0.70710677f;
constexpr std::array<std::array<float, 2>, 8> kFloorDirections{{{1, 0},
                                                                {kDiagonal, kDiagonal},
                                                                {0, 1},
                                                                {-kDiagonal, kDiagonal},
                                                                {-1, 0},
                                                                {-kDiagonal, -kDiagonal},
                                                                {0, -1},
                                                                {kDiagonal, -kDiagonal}}};

// From this radius in samples on, the coarse samples cannot miss a ball.
constexpr float kMinCoarseRadius = 4.0f;
// A disk is rejected if the visible pixels of the ball's color cover less than this share of it.
constexpr float kMinBallShare = 0.09f;

bool is_in(const Frame& frame, int u, int v) { return u >= 0 && v >= 0 && u < frame.width_px && v < frame.height_px; }

// Finds the median color of the floor around the ball.
bool look_at_floor(const Frame& frame, int u, int v, float radius_px, Rgb& out) {
  std::array<FixedVector<float, kFloorDirections.size()>, 3> values;
  const ColorSpace space = color_space(frame.format);
  const float reach = kFloorRadius * radius_px + 1.0f;
  for (const auto& [right, down] : kFloorDirections) {
    const int column = u + static_cast<int>(std::lround(reach * right));
    const int row = v + static_cast<int>(std::lround(reach * down));
    if (!is_in(frame, column, row)) continue;
    const auto pixel = pixel_at(frame, static_cast<std::size_t>(column), static_cast<std::size_t>(row));
    const Rgb rgb =
        to_rgb({static_cast<float>(pixel[0]), static_cast<float>(pixel[1]), static_cast<float>(pixel[2])}, space);
    for (std::size_t c = 0; c < 3; ++c) values[c].push_back(rgb[c]);
  }
  if (values[0].size() < kFloorDirections.size() / 2) return false;
  for (std::size_t c = 0; c < 3; ++c) {
    float* const middle = values[c].begin() + values[c].size() / 2;
    std::nth_element(values[c].begin(), middle, values[c].end());
    out[c] = *middle;
  }
  return true;
}

// Measures the second and fourth angular moments of the pixels of the ball's color around a disk, relative to the
// largest possible values. The grid is finer than that of the search, because shapes differ by few pixels.
void measure_shape(const Frame& frame, const BallColor& color, std::span<const TopOutline> tops, int center_u,
                   int center_v, float radius_px, BallAppearance& out) {
  const int step = static_cast<int>(std::ceil(kShapeSampleRadius * radius_px / static_cast<float>(kSampleReach)));
  const float radius = kShapeSampleRadius * radius_px / static_cast<float>(step);
  SampledPixels pixels(frame, center_u, center_v, step);
  const SampleRing disk(0.0f, radius);
  BallSamples samples(frame, pixels, tops, disk.reach, disk.reach);
  samples.read_dense(color, true);
  const Samples shape = samples.ball.without_holes(disk, 0, 0);
  using Four = Simd4<float>;
  const auto for_each = [&](const auto& add) {
    for (int row = -disk.reach; row <= disk.reach; ++row) {
      const Four y = Four{} + static_cast<float>(row);
      for_each_four(shape.row(row), [&](Four column, Simd4<std::int32_t> is_shape) {
        add(column - static_cast<float>(kSampleReach), y, is_shape);
      });
    }
  };
  Four ones{}, sum_x{}, sum_y{};
  for_each([&](Four x, Four y, Simd4<std::int32_t> is_shape) {
    ones += is_shape ? Four{1, 1, 1, 1} : Four{};
    sum_x += is_shape ? x : Four{};
    sum_y += is_shape ? y : Four{};
  });
  const float n = sum_of_lanes(ones);
  if (n == 0.0f) return;
  const float mean_x = sum_of_lanes(sum_x) / n, mean_y = sum_of_lanes(sum_y) / n;
  // Powers z^2 and z^4 of z = x + i y.
  Four real2{}, imaginary2{}, square2{}, real4{}, imaginary4{}, square4{};
  for_each([&](Four x, Four y, Simd4<std::int32_t> is_shape) {
    const Four dx = is_shape ? x - mean_x : Four{}, dy = is_shape ? y - mean_y : Four{};
    const Four re = dx * dx - dy * dy, im = 2 * dx * dy, size = dx * dx + dy * dy;
    real2 += re;
    imaginary2 += im;
    square2 += size;
    real4 += re * re - im * im;
    imaginary4 += 2 * re * im;
    square4 += size * size;
  });
  const float re2 = sum_of_lanes(real2), im2 = sum_of_lanes(imaginary2), size2 = sum_of_lanes(square2);
  const float re4 = sum_of_lanes(real4), im4 = sum_of_lanes(imaginary4), size4 = sum_of_lanes(square4);
  if (size2 <= 0.0f) return;
  out.elongation = std::sqrt(re2 * re2 + im2 * im2) / size2;
  out.squareness = std::sqrt(re4 * re4 + im4 * im4) / size4;
}

}  // namespace

bool look_at_ball(const Frame& frame, PixelPoint seed, float radius_px, const std::array<float, 3>& rgb,
                  std::span<const RobotTop> robots, BallAppearance& out) {
  // This rejects NaN, too.
  if (!(radius_px >= kMinAppearanceRadius_px && radius_px < 65536.0f)) return false;
  if (!(seed.u_px >= 0.0f && seed.v_px >= 0.0f && seed.u_px < 65536.0f && seed.v_px < 65536.0f)) return false;
  const int seed_u = static_cast<int>(std::lround(seed.u_px)), seed_v = static_cast<int>(std::lround(seed.v_px));
  if (!is_in(frame, seed_u, seed_v)) return false;
  Rgb floor{};
  if (!look_at_floor(frame, seed_u, seed_v, radius_px, floor)) return false;
  const BallColor color(rgb, floor);
  if (!color.differs_from_floor()) return false;

  const int step = static_cast<int>(std::ceil(radius_px / kMaxRadiusInSamples));
  const float radius = radius_px / static_cast<float>(step);
  const float inner = radius + std::max(1.0f, kRingGap_px / static_cast<float>(step));
  const float outer = std::max(kSurroundings * radius, inner + kMinRingWidth);
  const SampleRing disk(0.0f, radius), surroundings(inner, outer),
      ring(inner, inner + std::max(kMinRingWidth, kRingWidth * radius));
  const int search = static_cast<int>(radius), dense = search + ring.reach;
  // Offsets at which the center of the disk is tried.
  const SampleRing places(0.0f, static_cast<float>(search) + 0.01f);
  FixedVector<TopOutline, kMaxRobots> tops;
  for (const RobotTop& robot : robots) tops.push_back(TopOutline(robot));
  SampledPixels pixels(frame, seed_u, seed_v, step);
  BallSamples samples(frame, pixels, {tops.data(), tops.size()}, std::min(kSampleReach, search + surroundings.reach),
                      dense);
  const bool is_coarse_enough = radius >= kMinCoarseRadius;
  const int found = samples.read_coarse(color);
  if (is_coarse_enough && 4.0f * static_cast<float>(found) < kMinBallShare * static_cast<float>(disk.count))
    return false;
  samples.read_dense(color, !is_coarse_enough);
  const Samples& ball = samples.ball;

  // Find the best disk, or the mean of equally good ones.
  const SampleSums sums(ball, dense);
  float best = -1e9f, sum_u = 0, sum_v = 0, equal = 0;
  const auto add_row = [&](int row, int reach) {
    const SampleSums::Counts inside = sums.count(disk, -reach, row);
    SampleSums::Counts around{};
    bool is_counted = false;
    for (int column = -reach; column <= reach; ++column) {
      const int lane = column + reach;
      const auto i = static_cast<std::size_t>(lane);
      if (static_cast<float>(inside[i]) < best) continue;
      if (!is_counted) around = sums.count(ring, -reach, row);
      is_counted = true;
      float value = static_cast<float>(inside[i]) - kRingWeight * static_cast<float>(around[i]);
      if (!tops.empty()) {
        const int shown = samples.visible.count(disk, column, row);
        value -= kUnfilledWeight * static_cast<float>(shown - static_cast<int>(inside[i]));
      }
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
  };
  for (int row = -search; row <= search; ++row) add_row(row, places.last[static_cast<std::size_t>(std::abs(row))]);
  const int at_u = static_cast<int>(std::lround(sum_u / equal)), at_v = static_cast<int>(std::lround(sum_v / equal));
  const auto inside = static_cast<float>(ball.count(disk, at_u, at_v));
  // The reflection of a lamp has no color, but the ball's color surrounds it.
  const auto with_reflections = static_cast<float>(ball.without_holes(disk, at_u, at_v).count(disk, at_u, at_v));
  const auto shown = static_cast<float>(samples.visible.count(disk, at_u, at_v));
  const auto around = std::max(1.0f, static_cast<float>(samples.visible.count(ring, at_u, at_v)));
  if (inside < 1.0f) return false;
  // The outline is less sharp along each axis in which pixels share their chroma.
  const ChannelLayout& chroma = info_of(frame.format).channel[2];
  out.radius = radius_px / (1.0f + 0.25f * static_cast<float>(chroma.shift_u + chroma.shift_v));
  out.visible = shown / static_cast<float>(disk.count);
  out.filled = std::min(1.0f, with_reflections / shown);
  out.overflow = static_cast<float>(ball.count(ring, at_u, at_v)) / around;
  out.colorful = static_cast<float>(samples.colorful.count(surroundings, at_u, at_v)) /
                 std::max(1.0f, static_cast<float>(samples.coarse.count(surroundings, at_u, at_v)));
  out.area_px = with_reflections * static_cast<float>(step * step);

  float mean_u = 0, mean_v = 0;
  for (int row = std::max(-kSampleReach, at_v - disk.reach); row <= std::min(kSampleReach, at_v + disk.reach); ++row) {
    for (std::uint64_t bits = ball.row(row) & disk.at(row - at_v, at_u); bits != 0; bits &= bits - 1) {
      mean_u += static_cast<float>(std::countr_zero(bits) - kSampleReach) / inside;
      mean_v += static_cast<float>(row) / inside;
    }
  }
  out.center = {static_cast<float>(seed_u) + static_cast<float>(step) * mean_u,
                static_cast<float>(seed_v) + static_cast<float>(step) * mean_v};
  if (out.visible < kWholeBall) {
    out.center = {static_cast<float>(seed_u) + static_cast<float>(step) * sum_u / equal,
                  static_cast<float>(seed_v) + static_cast<float>(step) * sum_v / equal};
  }
  measure_shape(frame, color, {tops.data(), tops.size()}, seed_u + step * at_u, seed_v + step * at_v, radius_px, out);
  // Only the core is used, because the rim of a ball is darker than the patch from which the typical value was
  // measured.
  const SampleRing core(0.0f, std::max(1.0f, kCore * radius));
  const SampleRing& middle = ball.count(core, at_u, at_v) > 0 ? core : disk;
  const auto samples_in_middle = static_cast<float>(ball.count(middle, at_u, at_v));
  out.rgb = {};
  for (int row = std::max(-kSampleReach, at_v - middle.reach); row <= std::min(kSampleReach, at_v + middle.reach);
       ++row) {
    std::uint64_t columns = ball.row(row) & middle.at(row - at_v, at_u);
    if (columns != 0) pixels.select(row);
    while (columns != 0) {
      const int first = std::countr_zero(columns);
      PixelGroup group;
      pixels.read<1>(first - kSampleReach, group);
      for (std::size_t i = 0; i < kGroupSize; ++i) {
        const std::uint64_t bit = std::uint64_t{1} << (static_cast<unsigned>(first) + i);
        if ((columns & bit) == 0) continue;
        columns &= ~bit;
        for (std::size_t c = 0; c < 3; ++c) out.rgb[c] += group[c][i / 4][i % 4] / samples_in_middle;
      }
    }
  }
  return true;
}

}  // namespace touchline
