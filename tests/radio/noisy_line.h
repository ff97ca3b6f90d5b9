#pragma once

#include <cstddef>
#include <random>
#include <span>
#include <vector>

namespace touchline::testing {

/// A line that loses, changes and inserts bytes, each with a probability of one percent.
class NoisyLine {
 public:
  explicit NoisyLine(std::mt19937& random) : random_(random) {}

  /// Sends a packet. Returns false if noise hit it.
  bool send(std::span<const std::byte> packet) {
    bool intact = true;
    for (const std::byte sent : packet) {
      const int fault = fault_(random_);
      intact = intact && fault > 2;
      if (fault == 0) continue;
      received_.push_back(fault == 1 ? sent ^ static_cast<std::byte>(1 + byte_(random_) % 255) : sent);
      if (fault == 2) received_.push_back(static_cast<std::byte>(byte_(random_)));
    }
    return intact;
  }
  /// Returns all bytes that have arrived; more can be added.
  [[nodiscard]] std::vector<std::byte>& received() { return received_; }

 private:
  std::mt19937& random_;
  std::uniform_int_distribution<int> byte_{0, 255}, fault_{0, 99};
  std::vector<std::byte> received_;
};

}  // namespace touchline::testing
