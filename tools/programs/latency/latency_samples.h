#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/time.h"

namespace touchline::latency {

struct LatencySummary {
  Duration p50{}, p90{}, p99{}, p99_9{}, max{};

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit("p50", self.p50);
    visit("p90", self.p90);
    visit("p99", self.p99);
    visit("p99.9", self.p99_9);
    visit("max", self.max);
  }
};

/// Every duration of a run, so that percentiles are exact. All memory is taken and touched by the constructor.
class LatencySamples {
 public:
  explicit LatencySamples(std::size_t capacity) : samples_(capacity) {}
  /// Never allocates. A full one takes no more.
  void add(Duration duration) {
    if (count_ < samples_.size()) samples_[count_++] = duration;
  }
  [[nodiscard]] std::size_t count() const { return count_; }
  [[nodiscard]] Duration operator[](std::size_t i) const { return samples_[i]; }
  /// Nearest-rank percentiles; all zero without samples.
  [[nodiscard]] LatencySummary summarize() const;
  /// How many are longer.
  [[nodiscard]] std::uint64_t longer_than(Duration limit) const;

 private:
  std::vector<Duration> samples_;
  std::size_t count_ = 0;
};

}  // namespace touchline::latency
