#pragma once

#include <cstdint>

#include "tools/programs/control/drill.h"

namespace touchline::control_evaluation {

struct TrackingSettings {
  double speed_mps = 1.0;
  double rate_hz = 60.0;
  std::optional<double> true_delay_s, believed_delay_s;  // of the radio
  double settle_s = 0.0;                                 // before the round that does not count
};

struct TrackingResult {
  double bound_mm = 0.0;              // tracking_bound_m()
  double rms_mm = 0.0, max_mm = 0.0;  // distance of the robot from where the trajectory is at that time
};

/// Drives a figure eight of 1.8 x 0.56 m at constant speed for 20 s, after one round that does not count.
Result<TrackingResult> tracking_drill(const config::Configuration& configuration, const TrackingSettings& settings,
                                      std::uint64_t seed);

}  // namespace touchline::control_evaluation
