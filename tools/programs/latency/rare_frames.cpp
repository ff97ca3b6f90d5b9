#include "tools/programs/latency/rare_frames.h"

#include "tools/programs/statistics/peaks_over_threshold.h"

namespace touchline::latency {

RareFrames estimate_rare_frames(const std::string& span, const LatencySamples& samples, Duration deadline) {
  using statistics::Estimate;
  using statistics::PeaksOverThreshold;
  RareFrames rare;
  rare.span = span;
  std::vector<double> times_s(samples.count());
  for (std::size_t i = 0; i < times_s.size(); ++i) times_s[i] = seconds(samples[i]);
  const PeaksOverThreshold tail(times_s);
  if (!tail.is_enough()) {
    rare.refusal = times_s.size() < PeaksOverThreshold::kMinValues
                       ? "it needs " + std::to_string(PeaksOverThreshold::kMinValues) + " frames"
                       : "too many of the largest values are equal";
    return rare;
  }
  const statistics::TailTests tests = tail.test();
  rare.peaks = tail.peaks();
  rare.threshold = from_seconds(tail.threshold());
  rare.shape = tail.tail().shape;
  rare.independence = tests.independence;
  rare.stationarity = tests.stationarity;
  rare.fit = tests.fit;
  rare.refusal = PeaksOverThreshold::refusal(tests);
  if (!rare.refusal.empty()) return rare;
  const double most = PeaksOverThreshold::kReach * static_cast<double>(times_s.size());
  for (std::uint64_t one_in = 10; static_cast<double>(one_in) <= most; one_in *= 10) {
    if (one_in < times_s.size()) continue;
    const std::optional<Estimate> level = tail.level(1.0 / static_cast<double>(one_in));
    if (!level) continue;
    RareTime& time = rare.times.emplace_back();
    time = {one_in, from_seconds(level->value), from_seconds(level->low), std::nullopt};
    if (level->high) time.high = from_seconds(*level->high);
  }
  if (deadline > Duration::zero()) {
    if (const std::optional<Estimate> above = tail.probability_above(seconds(deadline))) {
      rare.misses = {above->value, above->low, above->high.value_or(1.0)};
    }
  }
  return rare;
}

}  // namespace touchline::latency
