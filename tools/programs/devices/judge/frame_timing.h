#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/time.h"

namespace touchline::devices {

/// Times at which a frame was taken and at which the program got it.
struct FrameTime {
  Instant capture{}, arrival{};
  std::uint32_t sequence = 0;  // number of the frame; a gap means lost frames
};

struct TimingReport {
  std::size_t frames = 0;
  std::uint64_t lost = 0;       // lost frames, counted from gaps in the frame numbers
  double delivered_hz = 0.0;    // rate of frames that arrived, by this computer's clock
  double period_s = 0.0;        // frame period of the camera, from time stamps and frame numbers
  double jitter_s = 0.0;        // RMS deviation of the time stamps from equal periods
  double worst_jitter_s = 0.0;  // largest deviation, absolute
  double delay_s = 0.0;         // median time from the stamp to the arrival at the program
  double worst_delay_s = 0.0;
  double delay_spread_s = 0.0;  // standard deviation of the delay
  bool increasing = true;       // each stamp is later than the previous one

  [[nodiscard]] double lost_share() const {
    const double all = static_cast<double>(frames) + static_cast<double>(lost);
    return all > 0.0 ? static_cast<double>(lost) / all : 0.0;
  }
};

/// `times`: at least three, in the order of arrival. Period and jitter come from a line fitted to the stamps over the
/// frame numbers.
TimingReport analyze_timing(std::span<const FrameTime> times);

}  // namespace touchline::devices
