#pragma once

#include <optional>

#include "core/types.h"

namespace touchline {

/// Predicts the time from the capture of the next frame to its packet: the measured times, smoothed over the last
/// frames.
class LatencyEstimate {
 public:
  /// Returns the prediction; zero before the first frame.
  [[nodiscard]] Duration value() const { return smoothed_.value_or(Duration::zero()); }
  void add(Duration measured) {
    const Duration smoothed = smoothed_.value_or(measured);
    smoothed_ = smoothed + (measured - smoothed) / kSmoothing;
  }

 private:
  // Number of frames over which the time is smoothed. Latency changes slowly, and a single late frame must not move the
  // prediction.
  static constexpr int kSmoothing = 16;

  std::optional<Duration> smoothed_;
};

}  // namespace touchline
