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

  /// Returns an SVG of the robot of `team` with `id`, and of the ball. Raw velocities are differences of consecutive
  /// sightings. `name`: the robot's name in the title.
  [[nodiscard]] std::string svg(Team team, RobotId id, const std::string& name) const;

  /// Returns the robot with an id that drove the longest way; kUnknownId if no robot with an id was seen.
  [[nodiscard]] std::pair<Team, RobotId> farthest() const;
  [[nodiscard]] bool knows(Team team, RobotId id) const { return robots_.count({team, id}) > 0; }

  // Values of one object in one frame. For a robot: x, y, heading, linear and angular velocity. For the ball: x, y, and
  // the velocities along x and y; its heading is unused.
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
