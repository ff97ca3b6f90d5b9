#pragma once

#include <random>

namespace touchline::testing {

/// Random numbers that are the same with every standard library.
class PortableRandom {
 public:
  explicit PortableRandom(std::uint32_t seed) : engine_(seed) {}

  /// Returns a uniformly distributed number in [low, high).
  float real(float low, float high) {
    return low + (high - low) * static_cast<float>(static_cast<double>(engine_()) / 4294967296.0);
  }
  /// Returns a uniformly distributed integer in [low, high].
  int whole(int low, int high) {
    return low + static_cast<int>(engine_() % static_cast<std::uint32_t>(high - low + 1));
  }

 private:
  std::mt19937 engine_;
};

}  // namespace touchline::testing
