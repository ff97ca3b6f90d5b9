#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <vector>

namespace touchline::hal::mock {

/// The random number generator xoshiro256** (Blackman and Vigna, "Scrambled linear pseudorandom number generators",
/// 2021), seeded by splitmix64. It replaces the standard library's distributions, whose results differ between
/// implementations, because a seed must give the same game everywhere.
class Random {
 public:
  /// Streams of the same seed are independent. Physics, radio and sensor use one stream each, so a change in one does
  /// not change the random numbers of the others.
  Random(std::uint64_t seed, std::uint64_t stream) {
    std::uint64_t x = seed + 0x9E3779B97F4A7C15U * (stream + 1);
    for (std::uint64_t& word : state_) {
      x += 0x9E3779B97F4A7C15U;
      std::uint64_t z = x;
      z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9U;
      z = (z ^ (z >> 27U)) * 0x94D049BB133111EBU;
      word = z ^ (z >> 31U);
    }
  }

  std::uint64_t bits() {
    const std::uint64_t result = rotate(state_[1] * 5, 7) * 9;
    const std::uint64_t t = state_[1] << 17U;
    state_[2] ^= state_[0];
    state_[3] ^= state_[1];
    state_[1] ^= state_[2];
    state_[0] ^= state_[3];
    state_[2] ^= t;
    state_[3] = rotate(state_[3], 45);
    return result;
  }
  /// Returns a uniformly distributed number in [0, 1).
  double uniform() { return static_cast<double>(bits() >> 11U) * 0x1p-53; }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// Returns true with this probability.
  bool bernoulli(double probability) { return uniform() < probability; }
  /// Returns a number from the standard normal distribution (Box and Muller 1958).
  double normal() {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
    return radius * std::cos(2.0 * std::numbers::pi * uniform());
  }
  /// Returns two independent numbers from the standard normal distribution, in little more than the time for one.
  std::array<double, 2> normal_pair() {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform())), angle = 2.0 * std::numbers::pi * uniform();
    return {radius * std::cos(angle), radius * std::sin(angle)};
  }
  /// Returns a number from the exponential distribution with mean 1.
  double exponential() { return -std::log(1.0 - uniform()); }

 private:
  static std::uint64_t rotate(std::uint64_t x, unsigned k) { return (x << k) | (x >> (64U - k)); }
  std::array<std::uint64_t, 4> state_{};
};

/// Table of 2^16 quantiles of the standard normal distribution. One 64-bit draw gives four values; that is fast enough
/// for image noise, which needs a million values per frame. No value exceeds 4.3 standard deviations.
class NormalTable {
 public:
  static constexpr std::size_t kSize = 65536;

  [[nodiscard]] float operator[](std::uint64_t sixteen_bits) const { return values_[sixteen_bits & 0xFFFFU]; }

 private:
  static std::vector<float> quantiles() {
    std::vector<float> values(kSize);
    // Newton's method on the error function finds the quantile at the middle of each bin.
    double x = -4.4;
    for (std::size_t i = 0; i < kSize; ++i) {
      const double p = (static_cast<double>(i) + 0.5) / static_cast<double>(kSize);
      for (int step = 0; step < 30; ++step) {
        const double error = 0.5 * std::erfc(-x / std::numbers::sqrt2) - p;
        const double density = std::exp(-0.5 * x * x) / std::sqrt(2.0 * std::numbers::pi);
        const double change = error / density;
        x -= change;
        if (std::abs(change) < 1e-9) break;
      }
      values[i] = static_cast<float>(x);
    }
    return values;
  }
  // Returns the table, which is computed only once because tests make many sensors.
  static const float* shared_quantiles() {
    static const std::vector<float> values = quantiles();
    return values.data();
  }

  const float* values_ = shared_quantiles();
};

}  // namespace touchline::hal::mock
