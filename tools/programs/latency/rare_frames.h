#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/time.h"
#include "tools/programs/latency/latency_samples.h"

namespace touchline::latency {

/// Time that one of `one_in` frames exceeds, with its 95 % confidence interval; without `high`, the data give no upper
/// limit.
struct RareTime {
  std::uint64_t one_in = 0;
  Duration time{}, low{};
  std::optional<Duration> high;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit("one_in", self.one_in);
    visit("time_ns", self.time);
    visit("low_ns", self.low);
    visit("high_ns", self.high);
  }
};

/// Share of frames above the deadline, with its 95 % confidence interval.
struct RareMisses {
  double share = 0.0, low = 0.0, high = 0.0;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit("share", self.share);
    visit("low", self.low);
    visit("high", self.high);
  }
};

/// Estimate for frames that are too rare to have been observed (statistics::PeaksOverThreshold).
struct RareFrames {
  std::string span;
  std::string refusal;      // reason why there is no estimate; empty: there is one
  std::uint64_t peaks = 0;  // number of the largest times that the estimate uses; 0: too few frames
  Duration threshold{};     // the times of the peaks are above this value
  double shape = 0.0;       // shape parameter of the tail
  double independence = 0.0, stationarity = 0.0, fit = 0.0;  // p-values of the tests
  std::vector<RareTime> times;
  std::optional<RareMisses> misses;  // empty: there is no deadline, or it is missed so often that misses can be counted

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit("span", self.span);
    visit("refusal", self.refusal);
    visit("peaks", self.peaks);
    visit("threshold_ns", self.threshold);
    visit("shape", self.shape);
    visit("independence_p", self.independence);
    visit("stationarity_p", self.stationarity);
    visit("fit_p", self.fit);
    visit("times", self.times);
    visit("misses", self.misses);
  }
};

/// Estimates the times that one of 10^k frames exceeds, for the powers of ten from the number of frames to 100 times as
/// many. `deadline`: zero if there is none. Takes about a second.
RareFrames estimate_rare_frames(const std::string& span, const LatencySamples& samples, Duration deadline);

}  // namespace touchline::latency
