#include "tools/programs/calibrate/colors/color_names.h"

#include <algorithm>
#include <cmath>

namespace touchline::calibrate {
namespace {

// Returns the angle between both colors in the plane of equal brightness.
double hue_difference_deg(const Rgb& a, const Rgb& b) {
  constexpr double kHalfTurn_deg = 180.0;
  const auto hue = [](const Rgb& rgb) {
    return std::atan2(std::sqrt(3.0) * (rgb[1] - rgb[2]), 2 * rgb[0] - rgb[1] - rgb[2]) * kHalfTurn_deg /
           std::acos(-1.0);
  };
  const double difference = std::abs(hue(a) - hue(b));
  return std::min(difference, 2 * kHalfTurn_deg - difference);
}

}  // namespace

Lab lab_of(const Rgb& rgb) {
  std::array<double, 3> linear{};
  for (std::size_t c = 0; c < 3; ++c) {
    const double x = std::clamp(rgb[c] / 255.0, 0.0, 1.0);
    linear[c] = x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4);
  }
  const auto f = [](double t) {
    constexpr double kKnee = 216.0 / 24389.0, kSlope = 24389.0 / 27.0;
    return t > kKnee ? std::cbrt(t) : (kSlope * t + 16.0) / 116.0;
  };
  const double x = f((0.4124 * linear[0] + 0.3576 * linear[1] + 0.1805 * linear[2]) / 0.9505);
  const double y = f(0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]);
  const double z = f((0.0193 * linear[0] + 0.1192 * linear[1] + 0.9505 * linear[2]) / 1.089);
  return {116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)};
}

double difference(const Lab& a, const Lab& b) {
  return std::sqrt(0.25 * (a.l - b.l) * (a.l - b.l) + (a.a - b.a) * (a.a - b.a) + (a.b - b.b) * (a.b - b.b));
}

double dissimilarity(const Lab& color, const Lab& expected) {
  constexpr double kLightness = 0.25, kChroma = 0.4, kHue = 1.5;
  const double l = color.l - expected.l, a = color.a - expected.a, b = color.b - expected.b;
  const double chroma = std::hypot(color.a, color.b) - std::hypot(expected.a, expected.b);
  const double hue = std::max(0.0, a * a + b * b - chroma * chroma);  // squared hue difference, as in CIE 1976
  return std::sqrt(kLightness * l * l + kChroma * chroma * chroma + kHue * hue);
}

double saturation(const Rgb& rgb) {
  const auto [least, most] = std::minmax_element(rgb.begin(), rgb.end());
  return (*most - *least) / (*most + kRatioOffset);
}

bool is_plausible(const std::optional<Rgb>& usual, const Rgb& seen) {
  if (!usual) return true;
  // Limits of saturation and hue: tinted lamps give a gray paint some saturation, and shade takes some from a colored
  // one.
  constexpr double kGrey = 0.12, kSaturated = 0.6, kColored = 0.3, kFarHue = 90.0;
  const double is = saturation(seen), should_be = saturation(*usual);
  if (should_be >= kColored && is < kGrey) return false;
  if (should_be < kGrey) return is < kSaturated;
  return is < kColored || hue_difference_deg(seen, *usual) <= kFarHue;
}

bool has_hue_of(const std::optional<Rgb>& usual, const Rgb& seen) {
  constexpr double kSaturated = 0.25, kNearHue_deg = 45.0;
  return usual && saturation(*usual) >= kSaturated && saturation(seen) >= kSaturated &&
         hue_difference_deg(seen, *usual) <= kNearHue_deg;
}

std::string_view most_similar_name(const Rgb& seen) {
  const Lab lab = lab_of(seen);
  const auto paints = usual_paints();
  const auto best = std::min_element(paints.begin(), paints.end(), [&](const auto& a, const auto& b) {
    return difference(lab_of(a.second), lab) < difference(lab_of(b.second), lab);
  });
  return best->first;
}

}  // namespace touchline::calibrate
