#include "core/marker/ball_color.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace touchline {
namespace {

using Rgb = BallColor::Rgb;

// Largest deviation of the hue: 20 degrees (orange and yellow are 35 degrees apart). From the ball's hue towards the
// next primary color, hues up to 8 degrees beyond the primary are accepted, but at most kMaxHueExcess_rad = 25 degrees.
// For a color without a hue, the relative deviation is limited instead.
constexpr float kHueTolerance_rad = 0.35f, kPastPrimary_rad = 0.14f, kMaxHueExcess_rad = 0.44f, kColorTolerance = 0.36f;
constexpr float kPixelNoise_levels = 5.0f;
// A pixel of the ball has at least this share of the ball's saturation, and of the difference between floor and ball.
constexpr float kMinSaturation = 0.3f, kMinContrast = 0.3f;
// Smallest usable distance between the colors of ball and floor in levels. Noise dominates smaller distances.
constexpr float kMinFloorDistance = 15.0f;
// Relative saturation below which a color has no hue: white, gray, black.
constexpr float kNoHue = 0.12f;
// Saturation of a robot's patch, relative to the ball's saturation.
constexpr float kColorful = 0.5f;

// Axes of the plane of colors without their white part: one towards red, one perpendicular to it.
constexpr Rgb kRed{0.8164966f, -0.4082483f, -0.4082483f}, kGreenToBlue{0.0f, 0.7071068f, -0.7071068f};

float dot(const Rgb& a, const Rgb& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Rgb minus(const Rgb& a, const Rgb& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
// Returns the color without its white part.
Rgb chroma_of(const Rgb& rgb) {
  const float mean = (rgb[0] + rgb[1] + rgb[2]) / 3.0f;
  return {rgb[0] - mean, rgb[1] - mean, rgb[2] - mean};
}

Simd4<float> broadcast4(float value) { return Simd4<float>{value, value, value, value}; }

// Sets bit i if lane i of the comparison is true.
std::uint32_t bits_of_eight(const std::array<Simd4<std::int32_t>, 2>& is_true) {
  using Four = Simd4<std::int32_t>;
  const Four bits = (is_true[0] & Four{1, 2, 4, 8}) | (is_true[1] & Four{16, 32, 64, 128});
  const auto halves = __builtin_bit_cast(std::array<std::uint64_t, 2>, bits);
  const std::uint64_t both = halves[0] | halves[1];
  return static_cast<std::uint32_t>(both | both >> 32u);
}

}  // namespace

BallColor::BallColor(const Rgb& ball, const Rgb& floor) : ball_(ball), floor_(floor) {
  const Rgb chroma = chroma_of(ball), of_floor = chroma_of(floor), way = minus(ball, floor);
  Rgb axis{};
  float saturation = std::sqrt(dot(chroma, chroma)), tolerance = kColorTolerance;
  const bool has_hue = saturation > kNoHue * std::sqrt(dot(ball, ball));
  if (!has_hue) {
    // If there is no hue, the color itself is compared.
    saturation = std::sqrt(dot(ball, ball));
    for (std::size_t c = 0; c < 3; ++c) axis[c] = ball[c] / saturation;
  } else {
    // Cameras that increase contrast clip weak channels of the dark side to zero, which moves its hue to a primary.
    const float hue = std::atan2(dot(chroma, kGreenToBlue), dot(chroma, kRed));
    const float beyond_primary = std::remainder(hue, 2.0f * std::numbers::pi_v<float> / 3.0f);
    const float more =
        std::clamp(std::abs(beyond_primary) + kPastPrimary_rad - kHueTolerance_rad, 0.0f, kMaxHueExcess_rad);
    const float middle = hue - std::copysign(0.5f * more, beyond_primary);
    for (std::size_t c = 0; c < 3; ++c) axis[c] = std::cos(middle) * kRed[c] + std::sin(middle) * kGreenToBlue[c];
    tolerance = std::tan(kHueTolerance_rad + 0.5f * more);
  }
  const float least_chroma = kColorful * (has_hue ? saturation : kNoHue * saturation) + kPixelNoise_levels;
  for (std::size_t c = 0; c < 3; ++c) {
    floor_chroma_[c] = broadcast4(of_floor[c]);
    way_[c] = broadcast4(way[c] / dot(way, way));
    hue_[c] = broadcast4(axis[c]);
  }
  least_way_ = broadcast4(kMinContrast + dot(floor, way) / dot(way, way));
  // The squared length of a color's white part is a third of its squared sum. Without a hue, the white part counts,
  // too.
  white_factor_ = broadcast4(has_hue ? 1.0f / 3.0f : 0.0f);
  least_along_ = broadcast4(kMinSaturation * saturation);
  tolerance_ = broadcast4(tolerance);
  least_chroma2_ = broadcast4(least_chroma * least_chroma);
}

bool BallColor::differs_from_floor() const {
  const Rgb way = minus(ball_, floor_);
  return dot(way, way) > kMinFloorDistance * kMinFloorDistance;
}

std::uint32_t BallColor::is_ball(const PixelGroup& rgb) const {
  std::array<Simd4<std::int32_t>, 2> is_like;
  for (std::size_t half = 0; half < 2; ++half) {
    is_like[half] = rgb[0][half] * way_[0] + rgb[1][half] * way_[1] + rgb[2][half] * way_[2] >= least_way_;
  }
  if (!any(is_like[0] | is_like[1])) return 0;
  for (std::size_t half = 0; half < 2; ++half) {
    const Simd4<float> r = rgb[0][half], g = rgb[1][half], b = rgb[2][half];
    const Simd4<float> sum = r + g + b;
    // The axis of a hue has no white part.
    const Simd4<float> along = r * hue_[0] + g * hue_[1] + b * hue_[2];
    // Rounding may make across2 negative, which does no harm because `allowed` is not 0.
    const Simd4<float> across2 = r * r + g * g + b * b - white_factor_ * sum * sum - along * along;
    const Simd4<float> allowed = kPixelNoise_levels + tolerance_ * along;
    is_like[half] &= (along > least_along_) & (across2 < allowed * allowed);
  }
  return bits_of_eight(is_like);
}

std::uint32_t BallColor::is_colorful(const PixelGroup& rgb) const {
  std::array<Simd4<std::int32_t>, 2> is_strong;
  for (std::size_t half = 0; half < 2; ++half) {
    const Simd4<float> r = rgb[0][half], g = rgb[1][half], b = rgb[2][half];
    const Simd4<float> white = (r + g + b) / 3.0f;
    const Simd4<float> x = r - white, y = g - white, z = b - white;
    const Simd4<float> dx = x - floor_chroma_[0], dy = y - floor_chroma_[1], dz = z - floor_chroma_[2];
    is_strong[half] = (x * x + y * y + z * z > least_chroma2_) & (dx * dx + dy * dy + dz * dz > least_chroma2_);
  }
  return bits_of_eight(is_strong);
}

}  // namespace touchline
