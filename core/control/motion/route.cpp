#include "core/control/motion/route.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/control/motion/speed_profile.h"
#include "core/geometry/angle.h"

namespace touchline {
namespace {

// A robot so near to the line through its goal drives straight on: a circle of any allowed radius would not correct it.
constexpr double kOnLine_m = 0.006;
// Share of a turn's time that a drive takes longer: the rest overlaps with acceleration and braking. Measured: the
// times of 200 random poses (tools/evaluate-control) fit best with it.
constexpr double kTurnShare = 0.85;
// Speeds for which the final circles are planned, as shares of the maximum. Slower circles are a turn in place.
constexpr std::array<double, 3> kCircleSpeeds{0.4, 0.7, 1.0};

double positive_angle(double angle) { return angle < 0.0 ? angle + 2.0 * std::numbers::pi : angle; }

class Candidates {
 public:
  Candidates(const MotionState& robot, const MotionGoal& goal, const MotionLimits& limits, const MotionArea& area)
      : robot_(robot), goal_(goal), limits_(limits), area_(area), way_(goal.place - robot.place), length_(norm(way_)) {}

  Route best() {
    for (const bool backward : {false, true}) {
      set_direction(backward);
      const bool stops = goal_.end_speed_mps <= 0.0;
      // Where a robot stops, it turns in place: on a circle at the end of braking it would save 0.1 s at most, and the
      // wheels' acceleration, which braking needs, would not suffice for both.
      if (stops || !goal_.direction_rad) {
        straight();
      } else if (!backward || !goal_.exact_heading) {
        circles(*goal_.direction_rad);
      }
    }
    // All circles leave the area, or the robot stands in all of them: it drives to the place and
    // looks again there. Nobody knows how long that takes.
    if (!std::isfinite(best_.time_s)) {
      for (const bool backward : {false, true}) {
        set_direction(backward);
        straight();
      }
      best_.time_s = std::numeric_limits<double>::infinity();
    }
    return best_;
  }

 private:
  void set_direction(bool backward) {
    backward_ = backward;
    begin_mps_ = backward ? -robot_.v_mps : robot_.v_mps;
    facing_rad_ = backward ? robot_.heading_rad + std::numbers::pi : robot_.heading_rad;
  }

  // Straight to the place; the heading is reached by a turn in place.
  void straight() {
    Route a;
    a.direction_rad = length_ > 1e-9 ? bearing(way_) : facing_rad_;
    a.line_m = length_;
    a.line_end_mps = a.end_mps = goal_.end_speed_mps;
    if (goal_.direction_rad) {
      const double final_heading = *goal_.direction_rad + (backward_ ? std::numbers::pi : 0.0);
      a.turn_at_end_rad = wrap_angle(final_heading - a.direction_rad);
      if (!goal_.exact_heading && std::abs(a.turn_at_end_rad) > 0.5 * std::numbers::pi)
        a.turn_at_end_rad -= std::copysign(std::numbers::pi, a.turn_at_end_rad);
    }
    consider(a);
  }

  // A line that is tangent to a circle, which leads to the goal with the wanted direction.
  void circles(double direction) {
    const Vector2 ahead = unit_vector(direction);
    const double behind = dot(way_, ahead), beside = cross(way_, ahead);  // beside: left of the line through the goal
    if (behind >= 0.0 && std::abs(beside) < kOnLine_m) {
      Route a;
      // Steers to the line within the way that is left, at least one robot's length.
      a.direction_rad = direction - std::atan2(beside, std::max(0.5 * behind, 2.0 * limits_.half_base_m));
      a.line_m = behind;
      a.line_end_mps = a.end_mps = goal_.end_speed_mps;
      consider(a);
      return;
    }
    double former = 0.0;
    for (const double share : kCircleSpeeds) {
      const double radius = limits_.radius_for(share * limits_.speed_mps);
      if (radius <= former) continue;
      former = radius;
      // Behind a circle that is too narrow for the end speed, a line leaves room to accelerate.
      const double arc_mps = limits_.speed_on(radius);
      const double end = std::min(goal_.end_speed_mps, limits_.speed_mps);
      const double run_up = end > arc_mps ? 0.5 * (end * end - arc_mps * arc_mps) / limits_.acceleration_mps2 : 0.0;
      for (const double side : {1.0, -1.0}) circle(ahead, direction, radius, side, run_up);
    }
    // The circle through the robot, if it is inside of the circles above.
    const double through = beside != 0.0 ? 0.5 * length_ * length_ / std::abs(beside) : 1e9;
    if (behind > 0.0 && through < former) circle(ahead, direction, through, std::copysign(1.0, beside), 0.0);
  }

  // side: 1 for a circle to the left of the final direction (the robot turns left on it).
  void circle(Vector2 ahead, double direction, double radius, double side, double run_up) {
    const Vector2 end = goal_.place - run_up * ahead;
    const Vector2 center = end + (side * radius) * perpendicular(ahead);
    const Vector2 from_center = robot_.place - center;
    const double square = dot(from_center, from_center) - radius * radius;
    // On the circle, rounding may put the robot inside.
    if (square < -1e-6 * radius) return;
    const double tangent = std::sqrt(std::max(0.0, square));
    // Angle, seen from the center, at which the line meets the circle.
    const double meets = bearing(from_center) + side * std::atan2(tangent, radius);
    const double arc = positive_angle(wrap_angle(side * (direction - side * 0.5 * std::numbers::pi - meets)));
    // More than this is a loop: another circle is always shorter.
    if (arc > 1.5 * std::numbers::pi) return;
    const Vector2 first = center + radius * unit_vector(meets);
    if (!area_.contains(first) || !area_.contains(center + radius * unit_vector(meets + side * 0.5 * arc))) return;
    Route a;
    a.direction_rad = meets + side * 0.5 * std::numbers::pi;
    a.line_m = tangent;
    a.arc_m = radius * arc + run_up;
    a.line_end_mps = limits_.speed_on(radius);
    a.end_mps = run_up > 0.0 ? goal_.end_speed_mps : std::min(goal_.end_speed_mps, a.line_end_mps);
    if (tangent < 1e-3 + 0.02 * radius) a.curvature_per_m = side / radius;
    consider(a);
  }

  void consider(Route& a) {
    const ProfileLimits driving{limits_.speed_mps, limits_.acceleration_mps2};
    const ProfileLimits turning{limits_.turn_radps, limits_.turn_acceleration_radps2};
    a.backward = backward_;
    const double error = wrap_angle(a.direction_rad - facing_rad_);
    const double towards = error < 0.0 ? -robot_.w_radps : robot_.w_radps;
    double time = kTurnShare * profile_time(std::abs(error), std::max(0.0, towards), 0.0, turning);
    if (a.turn_at_end_rad != 0.0) time += kTurnShare * profile_time(std::abs(a.turn_at_end_rad), 0.0, 0.0, turning);
    // A robot that has to turn far loses the part of its speed that points away.
    const double begin = begin_mps_ > 0.0 ? begin_mps_ * std::max(0.0, std::cos(error)) : begin_mps_;
    time += (begin_mps_ > begin ? begin_mps_ - begin : 0.0) / limits_.acceleration_mps2;
    time += profile_time(a.line_m, begin, a.line_end_mps, driving);
    if (a.arc_m > 0.0) {
      const double top = std::max(a.line_end_mps, a.end_mps);
      time += profile_time(a.arc_m, a.line_end_mps, a.end_mps, {top, limits_.acceleration_mps2});
    }
    // The last part of the acceleration to full speed follows the lag (motion_goal.h): its way is a lag^2 / 2 shorter.
    time += 0.5 * limits_.acceleration_mps2 * limits_.lag_s * limits_.lag_s / limits_.speed_mps;
    if (time >= best_.time_s) return;
    best_ = a;
    best_.time_s = time;
  }

  const MotionState& robot_;
  const MotionGoal& goal_;
  const MotionLimits& limits_;
  const MotionArea& area_;
  const Vector2 way_;
  const double length_;
  bool backward_ = false;
  double begin_mps_ = 0.0, facing_rad_ = 0.0;
  Route best_;
};

}  // namespace

Route best_route(const MotionState& robot, const MotionGoal& goal, const MotionLimits& limits, const MotionArea& area) {
  return Candidates(robot, goal, limits, area).best();
}

}  // namespace touchline
