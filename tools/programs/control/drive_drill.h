#pragma once

#include <cstdint>
#include <string>

#include "firmware/config/configuration.h"
#include "hal/result.h"

namespace touchline::control_evaluation {

/// True values of the robots, unlike those of the files.
struct DriveTruth {
  double delay_s = 0.018;  // of the radio, with the mean jitter
  double lag_s = 0.08;
  double wheel_error = 0.02;  // standard deviation of the wheels' gains
  double rate_hz = 60.0;
  double jitter_s = 0.003, loss = 0.03, slip = 0.03;
};

/// What the pipeline measured of the drives of its robots in a game.
struct DriveErrors {
  double delay_s = 0.0;                                            // after 10 s: of the team
  double lag_s = 0.0, gain = 0.0;                                  // after 30 s: of the team, and the RMS of all wheels
  double delay_sigmas = 0.0, lag_sigmas = 0.0, gain_sigmas = 0.0;  // the same, in stated standard deviations
  bool is_delay_known = false, is_lag_known = false;
  int robots = 0, known_robots = 0;  // known: both gains
};

/// Plays 30 s of a game of the built-in play against itself.
Result<DriveErrors> drive_drill(const config::Configuration& configuration, const DriveTruth& truth,
                                std::uint64_t seed);

}  // namespace touchline::control_evaluation
