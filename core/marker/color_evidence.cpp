#include "core/marker/color_evidence.h"

#include <algorithm>
#include <cmath>

namespace touchline {
namespace {

// Black level and stray light: added to both sides of a ratio, so that ratios of dark values mean less.
constexpr float kStrayLight_levels = 6.0f;
constexpr float kNoise_levels = 5.0f;
// Standard deviations of log ratios: between the same two colors under different lamps, per channel and common to all
// channels (patches of different gloss and height); between the gains of two channels (tint of a lamp).
constexpr float kRatioSigma = 0.15f, kCommonSigma = 0.2f, kTintSigma = 0.3f;
// Of a channel's gain, if its value is saturated.
constexpr float kSaturatedSigma = 0.5f;

// Between two places of the floor, per channel.
constexpr float kFloorSigma = 0.12f;

constexpr float square(float x) { return x * x; }

struct Expectation {
  std::array<float, 3> rgb{};
  std::array<float, 3> variance{};  // relative
};

// Errors are relative: 2 (a - b) / (a + b), which is nearly log(a / b). Their covariance is diagonal plus a term that
// is common to all channels; it is inverted with the formula of Sherman and Morrison.
float log_density(const SurfaceColor& surface, const Expectation& expected) {
  float weights = 0, sum = 0, squares = 0, determinant = 1;
  for (std::size_t c = 0; c < 3; ++c) {
    const float middle = 0.5f * (surface.rgb[c] + expected.rgb[c]) + kStrayLight_levels;
    float error = (surface.rgb[c] - expected.rgb[c]) / middle;
    // A saturated value is a lower bound.
    if (surface.saturated[c]) error = std::min(error, 0.0f);
    const float variance = expected.variance[c] + (square(kNoise_levels) + square(surface.spread)) / square(middle);
    const float weight = 1.0f / variance;
    weights += weight;
    sum += weight * error;
    squares += weight * error * error;
    determinant *= variance;
  }
  constexpr float kCommon = square(kCommonSigma);
  const float distance = squares - sum * sum / (1.0f / kCommon + weights);
  return -0.5f * (distance + std::log(determinant * (1.0f + kCommon * weights)));
}

}  // namespace

void ColorEvidence::configure(const TypicalColors& typical) {
  typical_ = typical;
  for (const ColorSpace space : {ColorSpace::kRgb, ColorSpace::kYuv}) {
    for (std::size_t color = 0; color < typical.value.size(); ++color) {
      std::array<float, 3> value{};
      std::copy(typical[color].begin(), typical[color].end(), value.begin());
      rgb_[static_cast<std::size_t>(space)][color] = to_rgb(value, space);
    }
  }
}

LocalLight ColorEvidence::light_on(const SurfaceColor& team_patch, ColorId team_color, ColorSpace space) const {
  const std::array<float, 3>& typical = rgb_of(team_color, space);
  LocalLight light;
  std::array<float, 3> ratio{};
  float sum = 0, weights = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    const float seen = team_patch.rgb[c] + kStrayLight_levels, expected = typical[c] + kStrayLight_levels;
    ratio[c] = seen / expected;
    light.variance[c] = (square(kNoise_levels) + square(kStrayLight_levels)) / square(expected) +
                        (square(kNoise_levels) + square(team_patch.spread)) / square(seen);
    if (team_patch.saturated[c] || typical[c] >= static_cast<float>(kSaturatedValue)) {
      light.variance[c] += square(kSaturatedSigma);
    }
    const float weight = 1.0f / (light.variance[c] + square(kTintSigma));
    sum += weight * ratio[c];
    weights += weight;
  }
  const float common = sum / weights;
  for (std::size_t c = 0; c < 3; ++c) {
    const float trust = square(kTintSigma) / (light.variance[c] + square(kTintSigma));
    light.gain[c] = common + trust * (ratio[c] - common);
    light.variance[c] *= trust;
  }
  return light;
}

float ColorEvidence::log_likelihood(const SurfaceColor& surface, const LocalLight& light, ColorId color,
                                    ColorSpace space) const {
  const std::array<float, 3>& typical = rgb_of(color, space);
  Expectation expected;
  for (std::size_t c = 0; c < 3; ++c) {
    expected.rgb[c] = light.gain[c] * typical[c];
    expected.variance[c] = square(kRatioSigma) + light.variance[c];
  }
  return std::max(log_density(surface, expected), kFloor);
}

float ColorEvidence::log_likelihood_of_same(const SurfaceColor& surface, const SurfaceColor& other) {
  Expectation expected;
  for (std::size_t c = 0; c < 3; ++c) {
    expected.rgb[c] = other.rgb[c];
    expected.variance[c] = square(kFloorSigma);
  }
  return std::max(log_density(surface, expected), kNoColor);
}

}  // namespace touchline
