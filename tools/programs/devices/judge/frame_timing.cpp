#include "tools/programs/devices/judge/frame_timing.h"

#include <algorithm>
#include <cmath>

#include "tools/programs/statistics/statistics.h"

namespace touchline::devices {

TimingReport analyze_timing(std::span<const FrameTime> times) {
  TimingReport report;
  report.frames = times.size();
  if (times.size() < 3) return report;
  const auto n = static_cast<double>(times.size());
  const auto number = [&](const FrameTime& time) { return static_cast<double>(time.sequence - times[0].sequence); };
  const auto stamp_s = [&](const FrameTime& time) { return seconds(time.capture - times[0].capture); };
  double mean_number = 0.0, mean_stamp_s = 0.0;
  for (const FrameTime& time : times) {
    mean_number += number(time) / n;
    mean_stamp_s += stamp_s(time) / n;
  }
  double covariance = 0.0, variance = 0.0;
  for (const FrameTime& time : times) {
    covariance += (number(time) - mean_number) * (stamp_s(time) - mean_stamp_s);
    variance += (number(time) - mean_number) * (number(time) - mean_number);
  }
  report.period_s = variance > 0.0 ? covariance / variance : 0.0;
  std::vector<double> delays_s;
  double squares = 0.0;
  for (std::size_t i = 0; i < times.size(); ++i) {
    const double error_s = stamp_s(times[i]) - mean_stamp_s - report.period_s * (number(times[i]) - mean_number);
    squares += error_s * error_s;
    report.worst_jitter_s = std::max(report.worst_jitter_s, std::abs(error_s));
    delays_s.push_back(seconds(times[i].arrival - times[i].capture));
    if (i == 0) continue;
    report.lost += times[i].sequence - times[i - 1].sequence - 1;
    report.increasing = report.increasing && times[i].capture > times[i - 1].capture;
  }
  report.jitter_s = std::sqrt(squares / n);
  const double span_s = seconds(times.back().arrival - times.front().arrival);
  report.delivered_hz = span_s > 0.0 ? (n - 1.0) / span_s : 0.0;
  report.worst_delay_s = *std::max_element(delays_s.begin(), delays_s.end());
  const double mean_delay_s = statistics::mean(delays_s);
  double spread = 0.0;
  for (const double delay_s : delays_s) spread += (delay_s - mean_delay_s) * (delay_s - mean_delay_s) / n;
  report.delay_spread_s = std::sqrt(spread);
  report.delay_s = statistics::median(delays_s);
  return report;
}

}  // namespace touchline::devices
