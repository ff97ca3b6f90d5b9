#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/types.h"
#include "firmware/config/venue_file.h"
#include "hal/result.h"

namespace touchline::calibrate {

/// Standard deviations of a resting object about its mean: each axis in m, heading in rad.
struct ObjectNoise {
  std::string name;
  std::size_t sightings = 0;
  double position_m = 0.0, heading_rad = 0.0;  // measured
  // Noise that the pictures show, RMS of all sightings. For robots it excludes errors that persist while the robot
  // stands.
  double shown_position_m = 0.0, shown_heading_rad = 0.0;
};

struct NoiseReport {
  std::vector<ObjectNoise> objects;
  std::vector<std::string> left_out;  // a line for each object that was not used, with the reason
  config::NoiseEntry entry;           // noise that the pictures do not show, RMS of all robots; 0: they show all of it
  bool has_ball = false;              // false: entry.ball_position_m was not measured
};

/// Measures the noise of robots and of a ball at rest (Klancar et al., section 7.1).
class NoiseMeasurement {
 public:
  void add(const Sightings& sightings);
  /// Objects that moved, or that were seen in fewer than 30 frames, are not used. kInconsistent: no robot remains.
  /// `teams`: names of the own team and of the opponent.
  [[nodiscard]] Result<NoiseReport> report(const std::array<std::string, 2>& teams) const;

 private:
  struct Observations {
    std::vector<double> x, y, theta;                // values in the order of the frames
    std::vector<double> position_var, heading_var;  // variances that the pictures show
  };
  std::map<std::pair<Team, RobotId>, Observations> robots_;
  Observations ball_;
};

}  // namespace touchline::calibrate
