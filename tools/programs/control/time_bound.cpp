#include "tools/programs/control/time_bound.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/geometry/angle.h"

namespace touchline::control_evaluation {
namespace {

// Rest to rest over a way with limits of speed and acceleration.
double time_over(double way, double max_speed, double acceleration) {
  const double ramp = max_speed * max_speed / acceleration;
  return way < ramp ? 2.0 * std::sqrt(way / acceleration) : way / max_speed + max_speed / acceleration;
}

}  // namespace

double least_time_s(const BoundPose& from, const BoundPose& to, const PipelineParameters& parameters) {
  const DriveParameters& drive = parameters.control.drive;
  const Vector2 way = to.place - from.place;
  const double half_base = 0.5 * drive.wheel_base_m, acceleration = drive.max_wheel_acceleration_mps2;
  const auto turn = [&](double angle) {
    return time_over(std::abs(wrap_angle(angle)), std::min(drive.max_turn_radps, drive.max_wheel_speed_mps / half_base),
                     acceleration / half_base);
  };
  const double straight = time_over(norm(way), drive.max_speed_mps, acceleration);
  double best = 1e9;
  for (const double back : {0.0, std::numbers::pi}) {
    const double line = bearing(way) + back;
    const double first = turn(line - from.heading_rad), last = turn(to.heading_rad - line);
    // While the robot accelerates or brakes, its speed is at most half of the largest in the first half of that time.
    const double overlap = 0.25 * std::min(straight, drive.max_speed_mps / acceleration * 2.0);
    const double apart = first + straight + last;
    const double together = straight + std::max(0.0, first - overlap) + std::max(0.0, last - overlap);
    best = std::min(best, 0.5 * (apart + together));
  }
  return best;
}

}  // namespace touchline::control_evaluation
