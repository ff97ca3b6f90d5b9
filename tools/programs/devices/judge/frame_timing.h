#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/time.h"

namespace touchline::devices {

/// When a frame was taken and when the program got it.
struct FrameTime {
  Instant capture{}, arrival{};
  std::uint32_t sequence = 0;  // a gap: lost frames
};

struct TimingReport {
  std::size_t frames = 0;
  std::uint64_t lost = 0;       // gaps in the numbers
  double delivered_hz = 0.0;    // frames that arrived, by the clock of this computer
  double period_s = 0.0;        // of the camera, from stamps and numbers
  double jitter_s = 0.0;        // of the stamps about equal periods, RMS
  double worst_jitter_s = 0.0;  // magnitude
  double delay_s = 0.0;         // from the stamp to the program, median
  double worst_delay_s = 0.0;
  double delay_spread_s = 0.0;  // standard deviation
  bool increasing = true;       // each stamp is later than the one before

  [[nodiscard]] double lost_share() const {
    const double all = static_cast<double>(frames) + static_cast<double>(lost);
    return all > 0.0 ? static_cast<double>(lost) / all : 0.0;
  }
};

/// `times` in the order of arrival, at least three. Period and jitter are those of a line through stamps over numbers.
TimingReport analyze_timing(std::span<const FrameTime> times);

}  // namespace touchline::devices
