#pragma once

#include <optional>

#include "core/types.h"

namespace touchline {

/// Time from the capture of a frame to its packet, smoothed over the last frames: the prediction for the next frame.
class LatencyEstimate {
 public:
  /// Zero before the first frame.
  [[nodiscard]] Duration value() const { return smoothed_.value_or(Duration::zero()); }
  void add(Duration measured) {
    const Duration smoothed = smoothed_.value_or(measured);
    smoothed_ = smoothed + (measured - smoothed) / kSmoothing;
  }

 private:
  // Latency changes slowly; a single late frame must not move the prediction of the next ones.
  static constexpr int kSmoothing = 16;

  std::optional<Duration> smoothed_;
};

}  // namespace touchline
