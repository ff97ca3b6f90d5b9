#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/time.h"

namespace touchline::latency {

struct TimeInterval {
  Duration low{}, high{};

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit("low", self.low);
    visit("high", self.high);
  }
};

struct LatencySummary {
  Duration p50{}, p90{}, p99{}, p99_9{}, max{};
  // 95 % confidence intervals (statistics::BlockBootstrap); empty if there are too few frames.
  std::optional<TimeInterval> p50_interval, p99_interval, p99_9_interval;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit("p50", self.p50);
    visit("p90", self.p90);
    visit("p99", self.p99);
    visit("p99.9", self.p99_9);
    visit("max", self.max);
    visit("p50_interval", self.p50_interval);
    visit("p99_interval", self.p99_interval);
    visit("p99.9_interval", self.p99_9_interval);
  }
};

/// Stores every duration of a measurement, so percentiles are exact. The constructor allocates and touches all memory.
class LatencySamples {
 public:
  explicit LatencySamples(std::size_t capacity) : samples_(capacity) {}
  /// Never allocates. Ignores the duration if the memory is full.
  void add(Duration duration) {
    if (count_ < samples_.size()) samples_[count_++] = duration;
  }
  [[nodiscard]] std::size_t count() const { return count_; }
  [[nodiscard]] Duration operator[](std::size_t i) const { return samples_[i]; }
  /// Computes nearest-rank percentiles and their intervals; all zero without samples.
  [[nodiscard]] LatencySummary summarize() const;
  /// Returns the number of samples longer than `limit`.
  [[nodiscard]] std::uint64_t longer_than(Duration limit) const;

 private:
  std::vector<Duration> samples_;
  std::size_t count_ = 0;
};

}  // namespace touchline::latency
