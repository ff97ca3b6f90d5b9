// Likelihood of colors for a surface: ColorEvidence::log_likelihoods(), log_likelihood_of_same() and their helpers.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/marker/color_errors.h"
#include "core/marker/color_evidence.h"

namespace touchline {
namespace {

using Floats = Simd4<float>;
using Lanes = Simd4<std::int32_t>;  // -1: true, 0: false

// Prior of glare: one patch in five mirrors a lamp, on average a tenth of its light (exponential distribution). The
// first constant is a log likelihood.
constexpr float kGlareIsRare = 1.6f, kMeanGlare = 0.1f;
// Standard deviation of the log ratio between two places of the floor, per channel.
constexpr float kFloorSigma = 0.12f;
// Log likelihood ratio of the first and of each further saturated channel that a color predicts with certainty. About
// one surface in seven that has no color saturates a channel, but white lines saturate all. A channel's share of
// kNoColor is included.
constexpr float kFirstSaturated = 1.9f + ColorEvidence::kNoColor / 3.0f;
constexpr float kNextSaturated = 0.7f + ColorEvidence::kNoColor / 3.0f;
// If the squared errors exceed this value, a density is below kFloor even without the saturated channels: the logarithm
// of three variances is at least 6 log(kRatioSigma).
constexpr float kFar = 40.0f;
static_assert(kRatioSigma >= 0.08f && kFloorSigma >= kRatioSigma &&
              -0.5f * (kFar - 15.2f) + kFirstSaturated < ColorEvidence::kFloor);

// Calls a function for the lanes that are needed; the others become 0.
template <class Function>
Floats for_lanes(Lanes needed, Floats x, Function function) {
  Floats out{};
  for (std::size_t lane = 0; lane < 4; ++lane) {
    if (needed[lane] != 0) out[lane] = function(x[lane]);
  }
  return out;
}

// Returns the logarithm of the probability that a standard normal variable exceeds z.
float log_upper_tail(float z) {
  constexpr float kFarthest = 6.0f;
  return std::log(0.5f * std::erfc(std::min(z, kFarthest) / std::numbers::sqrt2_v<float>));
}

// gcc 12 unrolls no loops at -O2, and without that keeps the values of a loop in memory.
//
// Errors are relative: 2 (a - b) / (a + b), which is nearly log(a / b). Their covariance is a diagonal matrix plus that
// of a factor common to all channels; it is inverted with the formula of Sherman and Morrison. A saturated value is a
// lower bound: its likelihood is the probability of larger values, given the other channels. Densities that are
// certainly below kFloor are not exact.
Floats log_densities(const SurfaceColor& surface, const ExpectedColors4& expected) {
  std::array<Floats, 3> error, variance;
  Floats precision = Floats{} + 1.0f, determinant = precision, sum{}, squares{};  // precision of the common factor
  _Pragma("GCC unroll 3") for (std::size_t c = 0; c < 3; ++c) {
    const Floats per_middle = 1.0f / (0.5f * (surface.rgb[c] + expected.rgb[c]) + kStrayLight_levels);
    error[c] = (surface.rgb[c] - expected.rgb[c]) * per_middle;
    const float noise = square(kNoise_levels) + square(surface.spread[c]);
    variance[c] = expected.variance[c] + noise * square(per_middle);
    if (surface.saturated[c]) continue;
    const Floats weight = 1.0f / variance[c], of_common = weight * expected.common_sigma[c];
    precision += of_common * expected.common_sigma[c];
    sum += of_common * error[c];
    squares += weight * square(error[c]);
    determinant *= variance[c];
  }
  const Floats common = sum / precision, misfit = squares - sum * common;
  const Lanes is_near = misfit < kFar;
  Floats density = -0.5f * (misfit + logarithm(determinant * precision));
  float evidence = kFirstSaturated;
  _Pragma("GCC unroll 3") for (std::size_t c = 0; c < 3; ++c) {
    if (!surface.saturated[c]) continue;
    const Floats sigma = square_root(variance[c] + square(expected.common_sigma[c]) / precision);
    density += std::exchange(evidence, kNextSaturated) +
               for_lanes(is_near, (error[c] - common * expected.common_sigma[c]) / sigma, log_upper_tail);
  }
  return density;
}

}  // namespace

void ExpectedColors4::set(std::size_t lane, const ExpectedColor& color) {
  for (std::size_t c = 0; c < 3; ++c) {
    rgb[c][lane] = color.rgb[c];
    white[c][lane] = color.white[c];
    variance[c][lane] = color.variance[c];
    common_sigma[c][lane] = color.common_sigma[c];
  }
}

Simd4<float> ColorEvidence::log_likelihoods(const SurfaceColor& surface, const ExpectedColors4& expected, float glare,
                                            Simd4<std::int32_t> in_box) {
  const bool is_glossy = glare > 0.0f;
  // Glare differs little between the patches of a robot.
  Floats density = log_densities(surface, expected) - glare / kMeanGlare;
  const Lanes may_be_whiter = is_glossy ? Lanes{} - 1 : in_box;
  if (any(may_be_whiter)) {
    // Least-squares estimate of the share of the lamps' light, in linear light: the patch plus this share is nearest to
    // the seen color.
    std::array<Floats, 3> variance;
    _Pragma("GCC unroll 3") for (std::size_t c = 0; c < 3; ++c) {
      const Floats middle = square(0.5f * (surface.rgb[c] + expected.rgb[c]) + kStrayLight_levels);
      variance[c] = middle * (middle * expected.variance[c] + square(kNoise_levels));
    }
    Floats sum{}, weights{};
    _Pragma("GCC unroll 3") for (std::size_t c = 0; c < 3; ++c) {
      const Floats white = square(expected.white[c]), weight = white / variance[c];
      sum += weight * (square(surface.rgb[c]) - square(expected.rgb[c]));
      weights += weight * white;
    }
    const Floats best = sum / weights;
    const Lanes is_whiter = may_be_whiter & (best > 0.0f);
    if (any(is_whiter)) {
      const Floats share = is_whiter ? best : Floats{};
      ExpectedColors4 whiter = expected;
      for (std::size_t c = 0; c < 3; ++c) {
        whiter.rgb[c] = square_root(square(expected.rgb[c]) + share * square(expected.white[c]));
      }
      const Floats more = share - glare;
      const Floats doubt = is_glossy ? (more < 0.0f ? -more : more) / kMeanGlare : kGlareIsRare + share / kMeanGlare;
      const Floats of_whiter = log_densities(surface, whiter) - doubt;
      density = (is_whiter & (of_whiter > density)) ? of_whiter : density;
    }
  }
  return density > kFloor ? density : kFloor;
}

float ColorEvidence::log_likelihood_of_same(const SurfaceColor& surface, const SurfaceColor& other) {
  ExpectedColors4 expected;
  for (std::size_t c = 0; c < 3; ++c) {
    expected.rgb[c] += other.rgb[c];
    expected.variance[c] += square(kFloorSigma);
    expected.common_sigma[c] += kCommonSigma;
  }
  return std::max(log_densities(surface, expected)[0], kNoColor);
}

}  // namespace touchline
