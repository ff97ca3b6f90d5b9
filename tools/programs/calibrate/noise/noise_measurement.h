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

/// Standard deviations about the mean of one standing object: each axis in m, heading in rad.
struct ObjectNoise {
  std::string name;
  std::size_t sightings = 0;
  double position_m = 0.0, heading_rad = 0.0;  // measured
  // That the pictures show, RMS of all sightings; of robots without the errors that last while they stand.
  double shown_position_m = 0.0, shown_heading_rad = 0.0;
};

struct NoiseReport {
  std::vector<ObjectNoise> objects;
  std::vector<std::string> left_out;  // a line for each object that was not used, with the reason
  config::NoiseEntry entry;           // what the pictures do not show, RMS of all robots; 0: they show all of it
  bool has_ball = false;              // false: entry.ball_position_m was not measured
};

/// Measures the noise of standing robots and of a resting ball (Klancar et al., section 7.1).
class NoiseMeasurement {
 public:
  void add(const Sightings& sightings);
  /// Objects that moved, and those seen in fewer than 30 frames, are left out. kInconsistent: no robot remains.
  /// `teams`: names of the own team and of the opponents.
  [[nodiscard]] Result<NoiseReport> report(const std::array<std::string, 2>& teams) const;

 private:
  struct Observations {
    std::vector<double> x, y, theta;                // in the order of the frames
    std::vector<double> position_var, heading_var;  // that the pictures show
  };
  std::map<std::pair<Team, RobotId>, Observations> robots_;
  Observations ball_;
};

}  // namespace touchline::calibrate
