#pragma once

namespace touchline {

// Black level and stray light, which are added to numerator and denominator so that ratios of dark values tend to 1.
constexpr float kStrayLight_levels = 6.0f;
constexpr float kNoise_levels = 5.0f;
// Standard deviations of log ratios between the same two colors: per channel, under the lamps of calibration and under
// lamps of any other spectrum (metamerism), and common to all channels (patches of different gloss and height).
constexpr float kRatioSigma = 0.08f, kOtherLampsSigma = 0.15f, kCommonSigma = 0.15f;

// Returns the square of a number, or of each of four.
template <class T>
constexpr T square(const T& x) {
  return x * x;
}

}  // namespace touchline
