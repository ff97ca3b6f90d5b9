#pragma once

#include <array>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/types.h"

namespace touchline::replay {

/// Collects the motion of all robots and of the ball, and draws figures 9 and 10 of the paper: sightings and tracks,
/// velocities, and innovations.
class MotionPlot {
 public:
  void add(const StepTrace& trace);

  /// SVG of the robot of `team` with `id`, and of the ball. Raw velocities are differences of consecutive sightings.
  /// `name`: of the robot, for the title.
  [[nodiscard]] std::string svg(Team team, RobotId id, const std::string& name) const;

  /// The robot with an id whose track is longest; kUnknownId if no robot with an id was seen.
  [[nodiscard]] std::pair<Team, RobotId> farthest() const;
  [[nodiscard]] bool knows(Team team, RobotId id) const { return robots_.count({team, id}) > 0; }

  // Values of one object in one frame. Robots: x, y, heading, linear and angular velocity; ball: x, y, velocities along
  // x and y, of which the heading is unused.
  struct Motion {
    double t_s = 0.0;
    bool sighted = false, tracked = false;
    std::array<double, 2> sighted_m{}, tracked_m{}, velocity{};
    double sighted_rad = 0.0, tracked_rad = 0.0;
    double innovation2 = -1.0;
  };
  using Motions = std::vector<Motion>;

 private:
  std::map<std::pair<Team, RobotId>, Motions> robots_;
  Motions ball_;
};

}  // namespace touchline::replay
