#include "tools/programs/calibrate/colors/robot_light.h"

#include <algorithm>
#include <cmath>

#include "tools/programs/statistics/statistics.h"

namespace touchline::calibrate {
namespace {

// Approximates the sRGB transfer function.
constexpr double kGamma = 2.2;
// Standard deviations of the logarithm of a channel, for a color that patches have shown and for a color that is known
// only by its name; limit of a channel's residual in standard deviations.
constexpr double kSeenSigma = 0.25, kNamedSigma = 0.6, kMaxResiduals = 4.0;
// Sensor noise and black level in linear light, which mask the ratios of dark channels.
constexpr double kNoiseFloor = 0.01;
// Largest value of a channel at the camera's black.
constexpr double kBlack = 2.0;
// Light factors and glare that are tried.
constexpr double kGains[] = {0.25, 0.35, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.15, 1.35, 1.6, 2.0};
constexpr double kGlares[] = {0, 0.01, 0.02, 0.04, 0.07, 0.1, 0.14, 0.18, 0.24, 0.3};
// Standard deviation of the logarithm of a robot's light factor; scale of the glare on a robot and of its difference on
// one patch.
constexpr double kGainSigma = 0.6, kGlareScale = 0.1;
// Largest change by the light on a robot that is usual, as the logarithm of its factor and as glare.
constexpr double kUsualGain = 0.25, kUsualGlare = 0.05;
// Share of the brightest channel of all colors above which a channel may be clipped.
constexpr double kClipped = 0.92;

double level_of(double linear) { return 255 * std::pow(std::clamp(linear, 0.0, 1.0), 1 / kGamma); }

// Cost of a color with each of kGlares.
using GlareCosts = std::array<double, std::size(kGlares)>;

GlareCosts costs_of(const ShownPatch& patch, double gain, double white) {
  const Look& look = patch.look;
  GlareCosts out{};
  for (std::size_t g = 0; g < out.size(); ++g) {
    double sum = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      const double expected = std::min(white, gain * look.color[c] + kGlares[g]);
      double residual = std::log((patch.seen[c] + kNoiseFloor) / (expected + kNoiseFloor)) / look.sigma;
      if (look.at_black[c]) residual = std::max(0.0, residual);
      sum += std::min(residual * residual, kMaxResiduals * kMaxResiduals);
    }
    // The second term normalizes the density. A wide distribution is lower at its peak, so it must not win because of
    // its small residuals.
    out[g] = sum / 2 + 3 * std::log(look.sigma / kSeenSigma);
  }
  return out;
}

// Returns the best glare of a patch; it differs little from the robot's, because one lamp shines on all patches.
PatchLight best_of(const GlareCosts& costs, double robot_glare) {
  PatchLight best{1e9, 0};
  for (std::size_t g = 0; g < costs.size(); ++g) {
    const double cost = costs[g] + std::abs(kGlares[g] - robot_glare) / kGlareScale;
    if (cost < best.cost) best = {cost, kGlares[g]};
  }
  return best;
}

}  // namespace

Linear linear(const Rgb& rgb) {
  Linear out{};
  for (std::size_t c = 0; c < 3; ++c) out[c] = std::pow(std::clamp(rgb[c], 0.0, 255.0) / 255, kGamma);
  return out;
}

bool Look::was_seen() const { return is_known() && sigma <= kSeenSigma; }

Look seen_look(const Rgb& rgb) {
  Look out{linear(rgb), kSeenSigma, {}};
  for (std::size_t k = 0; k < 3; ++k) out.at_black[k] = rgb[k] <= kBlack;
  return out;
}

Look named_look(const Rgb& rgb) { return {linear(rgb), kNamedSigma, {}}; }

PatchLight explain(const ShownPatch& patch, const RobotLight& light, const Brightness& brightness) {
  return best_of(costs_of(patch, light.gain, brightness.white), light.glare);
}

FittedLight fit_light(const std::vector<ShownPatch>& patches, const Brightness& brightness) {
  FittedLight best{{}, 1e9};
  for (const double gain : kGains) {
    std::vector<GlareCosts> costs;
    costs.reserve(patches.size());
    for (const ShownPatch& patch : patches) costs.push_back(costs_of(patch, gain, brightness.white));
    for (const double glare : kGlares) {
      double cost = std::pow(std::log(gain) / kGainSigma, 2) / 2 + glare / kGlareScale;
      for (const GlareCosts& of_patch : costs) cost += best_of(of_patch, glare).cost;
      if (cost < best.cost) best = {{gain, glare}, cost};
    }
  }
  return best;
}

bool is_odd(const RobotLight& light, const std::vector<ShownPatch>& patches, const Brightness& brightness) {
  if (std::abs(std::log(light.gain)) > kUsualGain) return true;
  return std::any_of(patches.begin(), patches.end(),
                     [&](const ShownPatch& patch) { return explain(patch, light, brightness).glare > kUsualGlare; });
}

LightRemoval::LightRemoval(const RobotLight& light, const std::vector<ShownPatch>& others, const Brightness& brightness)
    : gain_(std::min(1.0, light.gain)),  // A larger factor counts as glare.
      brightness_(brightness) {
  // The glare can be computed from channels that are neither black without it nor clipped with it.
  std::vector<double> glares;
  for (const ShownPatch& patch : others) {
    for (std::size_t c = 0; c < 3; ++c) {
      if (!patch.look.at_black[c] && patch.seen[c] < kClipped * brightness_.most)
        glares.push_back(std::max(0.0, patch.seen[c] - gain_ * patch.look.color[c]));
    }
  }
  if (glares.empty()) {
    // Black and clipped channels give only a lower bound of the glare.
    glare_ = {light.glare, light.glare + kGlareScale / 2, light.glare + kGlareScale};
    return;
  }
  const auto [least, most] = std::minmax_element(glares.begin(), glares.end());
  glare_ = {*least, statistics::mean(glares), *most};
}

Rgb LightRemoval::without_light(const Rgb& rgb, std::size_t which) const {
  const Linear value = linear(rgb);
  Rgb out{};
  for (std::size_t c = 0; c < 3; ++c) {
    double usual = (value[c] - glare_[which]) / gain_;
    if (value[c] >= kClipped * brightness_.most) {
      const double greater = 1 - static_cast<double>(which) / (kCount - 1);
      usual += std::max(0.0, brightness_.most - usual) * greater;
    }
    out[c] = level_of(usual);
  }
  return out;
}

}  // namespace touchline::calibrate
