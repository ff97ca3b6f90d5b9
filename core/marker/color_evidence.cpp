#include "core/marker/color_evidence.h"

#include <algorithm>
#include <cmath>

#include "core/light/shading.h"

namespace touchline {
namespace {

// Values from this one upwards count as saturated.
constexpr int kSaturated = 250;
// Black level and stray light: added to both sides of a ratio, so that ratios of dark values mean less.
constexpr float kStrayLight_levels = 6.0f;
constexpr float kNoise_levels = 5.0f;
// Standard deviations of log ratios: between the same two colors under different lamps, per channel and common to all
// channels (patches of different gloss and height); between the gains of two channels (tint of a lamp).
constexpr float kRatioSigma = 0.15f, kCommonSigma = 0.2f, kTintSigma = 0.3f;
// Of a channel's gain, if its value is saturated.
constexpr float kSaturatedSigma = 0.5f;
// Part of the range of nine samples that counts as error of their mean. (Nine values with the standard deviation 1 have
// a range of 3, and their mean has an error of 1/3.)
constexpr float kRangeError = 0.25f;

constexpr float square(float x) { return x * x; }

// R, G, B above black.
std::array<float, 3> to_rgb(const std::array<float, 3>& value, ColorSpace space) {
  if (space == ColorSpace::kRgb) return value;
  const float y = 1.164f * (value[0] - static_cast<float>(black_value(space, 0)));
  const float u = value[1] - static_cast<float>(black_value(space, 1));
  const float v = value[2] - static_cast<float>(black_value(space, 2));
  return {std::max(0.0f, y + 1.596f * v), std::max(0.0f, y - 0.392f * u - 0.813f * v), std::max(0.0f, y + 2.017f * u)};
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

bool ColorEvidence::sample(const Frame& frame, PixelPoint center, int step_px, SurfaceColor& out) {
  // Also false for NaN.
  if (!(center.u_px >= 0.0f && center.v_px >= 0.0f && center.u_px < 65536.0f && center.v_px < 65536.0f)) return false;
  const int u = static_cast<int>(center.u_px + 0.5f), v = static_cast<int>(center.v_px + 0.5f);
  if (u < step_px || v < step_px || u + step_px >= frame.width_px || v + step_px >= frame.height_px) return false;
  const PixelFormatInfo& info = info_of(frame.format);
  std::array<float, 3> mean{};
  std::array<int, 3> most{};
  int range = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    const ChannelLayout& channel = info.channel[c];
    const auto offset = [&](int column) { return channel.byte(static_cast<std::size_t>(column)); };
    const std::array<std::size_t, 3> offsets{offset(u - step_px), offset(u), offset(u + step_px)};
    int sum = 0, low = 255, high = 0;
    for (const int row : {v - step_px, v, v + step_px}) {
      const std::size_t plane_row = static_cast<std::size_t>(row) >> channel.shift_v;
      const std::uint8_t* const pixels = frame.plane[channel.plane] + plane_row * frame.stride_bytes[channel.plane];
      const int a = pixels[offsets[0]], b = pixels[offsets[1]], d = pixels[offsets[2]];
      sum += a + b + d;
      low = std::min({low, a, b, d});
      high = std::max({high, a, b, d});
    }
    mean[c] = static_cast<float>(sum - low - high) / 7.0f;
    most[c] = high;
    range = std::max(range, high - low);
  }
  out.spread = kRangeError * static_cast<float>(range);
  out.rgb = to_rgb(mean, info.space);
  for (std::size_t c = 0; c < 3; ++c) {
    out.saturated[c] = info.space == ColorSpace::kRgb ? most[c] >= kSaturated : out.rgb[c] >= kSaturated;
  }
  return true;
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
    if (team_patch.saturated[c] || typical[c] >= static_cast<float>(kSaturated)) {
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
  // Errors are relative: 2 (a - b) / (a + b), which is nearly log(a / b). Their covariance is diagonal plus a term that
  // is common to all channels; it is inverted with the formula of Sherman and Morrison.
  float weights = 0, sum = 0, squares = 0, determinant = 1;
  for (std::size_t c = 0; c < 3; ++c) {
    const float expected = light.gain[c] * typical[c];
    const float middle = 0.5f * (surface.rgb[c] + expected) + kStrayLight_levels;
    float error = (surface.rgb[c] - expected) / middle;
    // A saturated value is a lower bound.
    if (surface.saturated[c]) error = std::min(error, 0.0f);
    const float variance = square(kRatioSigma) + light.variance[c] * square(expected / middle) +
                           (square(kNoise_levels) + square(surface.spread)) / square(middle);
    const float weight = 1.0f / variance;
    weights += weight;
    sum += weight * error;
    squares += weight * error * error;
    determinant *= variance;
  }
  constexpr float kCommon = square(kCommonSigma);
  const float distance = squares - sum * sum / (1.0f / kCommon + weights);
  const float log_density = -0.5f * (distance + std::log(determinant * (1.0f + kCommon * weights)));
  return std::max(log_density, kFloor);
}

}  // namespace touchline
