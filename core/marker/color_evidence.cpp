#include "core/marker/color_evidence.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/marker/color_errors.h"

namespace touchline {
namespace {

// Part of a tint of the light by which the ratios of paints may change.
constexpr float kTintEffect = 0.5f;
// Value of a white surface; share of the lamps' light that any patch mirrors, and that a team patch mirrors.
constexpr float kWhite = 255.0f, kHaze = 0.01f, kHazeOfTeamPatch = 0.02f;
// Glare on the team patch is measured in channels that its color leaves dark: below this value relative to the
// brightest channel. Smaller glare is attributed to stray light and gloss.
constexpr float kDarkInColor = 0.4f, kMinGlare = 0.02f;
// Expected factor by which the light of a saturated channel exceeds its lower bound.
constexpr float kSaturatedGain = 1.5f;
// Standard deviation of the log gain of a saturated channel.
constexpr float kSaturatedSigma = 0.5f;

// Standard deviations of the log ratio between the light on a robot and the light of the field around it: common to all
// channels, and per channel. They differ because robots are higher than the floor, and their gloss is not that of the
// calibration.
constexpr float kFieldSigma = 0.12f, kFieldTintSigma = 0.06f;
// Degrees of freedom of the prior: a gain far from the expected one widens the prior like a Student distribution,
// because a robot may stand in a shadow that the field around it does not show.
constexpr float kDegreesOfFreedom = 3.0f;
// Model error of a border's color, added to the error that its pixels show, and the probability of an outlier: another
// object beside the patch.
constexpr float kBorderSigma = 0.06f, kForeignBorder = 0.05f;
// Share of kNoColor that belongs to the two ratios of channels.
constexpr float kNoBorderColor = ColorEvidence::kNoColor * 2.0f / 3.0f;
// Error of a channel in which the patch is as dark as its surroundings, relative to the color's linear light.
constexpr float kMinExcess = 0.3f;

// Returns the variance of a channel's log value (gamma 2) if the patch mirrors a share of the lamps' light. Dark values
// vary more.
float haze_variance(float value, float white, float share) {
  return square(0.5f * share * square(white) / square(value + kStrayLight_levels));
}

// Estimates the share of the lamps' light that a patch of this color mirrors: the minimum over its dark channels,
// because a lamp of another tint brightens one of them, but not all. In linear light, as a share of `white`.
float glare_on(const SurfaceColor& patch, const std::array<float, 3>& typical, const LightPrior& prior) {
  const float brightest = std::max({typical[0], typical[1], typical[2]});
  // The gain follows from the brighter channels, unless they are saturated.
  float gain = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    if (typical[c] < kDarkInColor * brightest) continue;
    const float seen = patch.rgb[c] / (prior.gain[c] * typical[c]);
    gain = std::max(gain, patch.saturated[c] ? kSaturatedGain * seen : seen);
  }
  float glare = std::numeric_limits<float>::max();
  for (std::size_t c = 0; c < 3; ++c) {
    if (typical[c] >= kDarkInColor * brightest) continue;
    const float white = prior.gain[c] * kWhite, expected = gain * prior.gain[c] * typical[c];
    glare = std::min(glare, (square(patch.rgb[c]) - square(expected)) / square(white));
  }
  return glare < 1.0f ? std::max(0.0f, glare - kMinGlare) : 0.0f;
}

// Sum of the channels' squared errors in standard deviations, after their common part is removed.
struct RatioErrors {
  float squares = 0;
  float weights = 0;  // sum of the channels' inverse variances
};
RatioErrors ratio_errors(const std::array<float, 3>& deviation, const std::array<float, 3>& variance) {
  RatioErrors out;
  float sum = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    sum += deviation[c] / variance[c];
    out.weights += 1.0f / variance[c];
  }
  for (std::size_t c = 0; c < 3; ++c) out.squares += square(deviation[c] - sum / out.weights) / variance[c];
  return out;
}

}  // namespace

LightPrior expected_light(const ExpectedGain& light, PixelPoint at) {
  LightPrior prior;
  if (!light.is_known()) return prior;
  prior.gain = light.at(at);
  prior.common_sigma = kFieldSigma;
  prior.tint_sigma = kFieldTintSigma;
  return prior;
}

LocalLight light_around(const LightPrior& prior) {
  LocalLight light;
  light.gain = prior.gain;
  light.variance.fill(square(prior.tint_sigma));
  light.common_variance.fill(square(prior.common_sigma));
  light.ratio_variance = square(kRatioSigma);
  return light;
}

void ColorEvidence::configure(const TypicalColors& typical) {
  typical_ = typical;
  for (const ColorSpace space : kColorSpaces) {
    for (std::size_t color = 0; color < typical.value.size(); ++color) {
      std::array<float, 3> value{};
      std::copy(typical[color].begin(), typical[color].end(), value.begin());
      rgb_[static_cast<std::size_t>(space)][color] = to_rgb(value, space);
    }
  }
}

bool ColorEvidence::can_name(const TeamMarking& team) const {
  return team.team_color != kBackground && team.layout.patches.size() > 1 && !team.robots.empty() &&
         knows(team.team_color) &&
         std::all_of(team.robots.begin(), team.robots.end(), [this](const RobotMarking& robot) {
           return std::all_of(robot.colors.begin(), robot.colors.end(), [this](ColorId color) { return knows(color); });
         });
}

LocalLight ColorEvidence::light_on(const SurfaceColor& seen_patch, ColorId team_color, ColorSpace space,
                                   const LightPrior& prior) const {
  const std::array<float, 3>& typical = typical_rgb(team_color, space);
  LocalLight light;
  light.glare = glare_on(seen_patch, typical, prior);
  SurfaceColor team_patch = seen_patch;
  for (std::size_t c = 0; c < 3 && light.glare > 0.0f; ++c) {
    const float white = prior.gain[c] * kWhite;
    team_patch.rgb[c] = std::sqrt(std::max(0.0f, square(seen_patch.rgb[c]) - light.glare * square(white)));
  }
  std::array<float, 3> deviation{}, weight{};  // deviation of the gain's logarithm from the prior's
  std::array<bool, 3> counts{};
  float sum = 0, weights = 0;
  const auto add = [&](std::size_t c) {
    counts[c] = true;
    sum += weight[c] * deviation[c];
    weights += weight[c];
  };
  for (std::size_t c = 0; c < 3; ++c) {
    const float seen = team_patch.rgb[c] + kStrayLight_levels;
    const float expected = prior.gain[c] * typical[c] + kStrayLight_levels;
    deviation[c] = std::log(seen / expected);
    light.variance[c] = (square(kNoise_levels) + square(kStrayLight_levels)) / square(expected) +
                        (square(kNoise_levels) + square(team_patch.spread[c])) / square(seen) +
                        haze_variance(expected, prior.gain[c] * kWhite, kHazeOfTeamPatch);
    const bool is_typically_saturated = typical[c] >= static_cast<float>(kSaturatedValue);
    if (is_typically_saturated) light.variance[c] += square(kSaturatedSigma);
    weight[c] = 1.0f / (light.variance[c] + square(prior.tint_sigma));
    if (!team_patch.saturated[c] || is_typically_saturated) add(c);
  }
  // Precision of the common part before the patch is seen.
  const float surprise = weights > 0.0f ? square(sum / weights) / (square(prior.common_sigma) + 1.0f / weights) : 0.0f;
  const float widened = (kDegreesOfFreedom + surprise) / (kDegreesOfFreedom + 1.0f);
  const float precision = 1.0f / (square(prior.common_sigma) * std::max(1.0f, widened));
  // A saturated channel gives a lower bound, so it counts only if the light would otherwise be darker.
  const float known = sum / (precision + weights);
  for (std::size_t c = 0; c < 3; ++c) {
    if (!counts[c] && deviation[c] > known) add(c);
  }
  const float common = sum / (precision + weights);
  std::array<float, 3> tint{};
  for (std::size_t c = 0; c < 3; ++c) {
    const float trust = counts[c] ? square(prior.tint_sigma) * weight[c] : 0.0f;
    light.gain[c] = prior.gain[c] * std::exp(common + trust * (deviation[c] - common));
    tint[c] = std::log(light.gain[c]);
    light.variance[c] = (1.0f - trust) * square(prior.tint_sigma);
    light.common_variance[c] = square(1.0f - trust) / (precision + weights);
  }
  const float mean = (tint[0] + tint[1] + tint[2]) / 3.0f;
  const float change = (square(tint[0] - mean) + square(tint[1] - mean) + square(tint[2] - mean)) / 3.0f;
  light.ratio_variance = std::min(square(kRatioSigma) + square(kTintEffect) * change, square(kOtherLampsSigma));
  return light;
}

ExpectedColor ColorEvidence::expected_color(const LocalLight& light, ColorId color, ColorSpace space) const {
  const std::array<float, 3>& typical = typical_rgb(color, space);
  ExpectedColor expected;
  for (std::size_t c = 0; c < 3; ++c) {
    expected.rgb[c] = light.gain[c] * typical[c];
    expected.white[c] = light.gain[c] * kWhite;
    expected.variance[c] =
        light.ratio_variance + light.variance[c] + haze_variance(expected.rgb[c], expected.white[c], kHaze);
    expected.common_sigma[c] = std::sqrt(square(kCommonSigma) + light.common_variance[c]);
  }
  return expected;
}

// Returns the deviations of a border's channels from a color, as logarithms of values, and the errors of this patch
// alone.
ColorEvidence::BorderDeviation ColorEvidence::deviation_of(const BorderColor& border, const LocalLight& light,
                                                           ColorId color, ColorSpace space) const {
  const std::array<float, 3>& typical = typical_rgb(color, space);
  BorderDeviation out;
  for (std::size_t c = 0; c < 3; ++c) {
    const float value = light.gain[c] * typical[c], linear = square(value + kStrayLight_levels);
    // Error of log linear light: twice the error of the log value. A dark channel hardly differs from its surroundings.
    const float excess = std::max(linear - border.background[c], kMinExcess * linear);
    out.slope[c] = linear / excess;
    out.value[c] = 0.5f * std::log(border.excess[c] / excess);
    out.variance[c] =
        square(out.slope[c]) * (light.ratio_variance + haze_variance(value, light.gain[c] * kWhite, kHaze)) +
        square(0.5f * border.error[c]);
  }
  return out;
}

float ColorEvidence::log_likelihood_of_border(const BorderColor& border, const LocalLight& light, ColorId color,
                                              ColorSpace space) const {
  BorderDeviation deviation = deviation_of(border, light, color, space);
  float determinant = 1;
  for (std::size_t c = 0; c < 3; ++c) {
    float& variance = deviation.variance[c];
    variance += square(deviation.slope[c]) * light.variance[c] + square(kBorderSigma);
    determinant *= variance;
  }
  const RatioErrors errors = ratio_errors(deviation.value, deviation.variance);
  const float density = -0.5f * (errors.squares + std::log(determinant * errors.weights)) - kNoBorderColor;
  return std::log((1.0f - kForeignBorder) * std::exp(density) + kForeignBorder);
}

float ColorEvidence::log_likelihood_of_order(const BorderOfRobot& a, ColorId color_of_a, const BorderOfRobot& b,
                                             ColorId color_of_b, ColorSpace space) const {
  const auto half_squares = [&](ColorId of_a, ColorId of_b) {
    BorderDeviation deviation = deviation_of(a.border, a.light, of_a, space);
    const BorderDeviation other = deviation_of(b.border, b.light, of_b, space);
    for (std::size_t c = 0; c < 3; ++c) {
      deviation.value[c] -= other.value[c];
      deviation.variance[c] += other.variance[c];
    }
    return 0.5f * ratio_errors(deviation.value, deviation.variance).squares;
  };
  return half_squares(color_of_b, color_of_a) - half_squares(color_of_a, color_of_b);
}

}  // namespace touchline
