#include "core/control/motion/drive_through.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/geometry/angle.h"

namespace touchline {
namespace {

using std::numbers::pi;
// Sideways acceleration in a curve, in m/s^2: rubber tires slide between 5 and 8; less if the stated grip is less.
constexpr double kCurveGrip = 5.0;
double curve_grip(const DriveParameters& drive) { return std::min(kCurveGrip, MotionLimits(drive).lateral_mps2); }

constexpr double kTurnPerS = 25.0;
// The robot begins to turn so far before the arc, because its wheels lag, and ends so far before the arc's end.
constexpr double kLeadM = 0.04;
// Radii of the arc. With these, the gain and kResponseS, the most of 150 resting balls were struck towards the
// goal (docs/control.md).
constexpr double kTightM = 0.06, kWideM = 0.18;
// Where a robot counts as arrived on the line through the place, and steers along it: the run-up of a strike and the
// half of a robot.
constexpr double kArrivedM = 0.08, kBesideM = 0.03, kAlongRad = 0.6;

// A robot that drives ahead with either end.
struct Rover {
  Vector2 position;
  double heading = 0.0;  // of the motion
  double speed = 0.0;    // in this direction
};

Rover rover_of(const MotionState& robot, bool backward, double after_s) {
  const double middle = robot.heading_rad + 0.5 * after_s * robot.w_radps;
  Rover out;
  out.position = robot.place + (after_s * robot.v_mps) * unit_vector(middle);
  out.heading = wrap_angle(robot.heading_rad + after_s * robot.w_radps + (backward ? pi : 0.0));
  out.speed = backward ? -robot.v_mps : robot.v_mps;
  return out;
}

// The way from a robot to its goal: turn, line, arc.
struct Way {
  double direction = 0.0;  // in which it begins
  double curvature = 0.0;  // at its begin, 1/m
  double line_m = 0.0, arc_m = 0.0, radius_m = 1e3;
};

double length(Vector2 v) { return std::sqrt(dot(v, v)); }

// The line through a goal along its direction, seen from the robot.
struct GoalLine {
  GoalLine(Vector2 from, const MotionGoal& goal)
      : direction(*goal.direction_rad),
        ahead(unit_vector(direction)),
        x(dot(from - goal.place, ahead)),
        y(cross(ahead, from - goal.place)),
        distance_m(std::sqrt(x * x + y * y)) {}
  double direction;
  Vector2 ahead;
  double x, y;  // of the robot, along the direction and to its left
  double distance_m;
};

// At the place, or beyond it towards the ball: along the direction, with a correction towards the line.
bool is_on_line(const GoalLine& line, double heading) {
  return line.x > -0.02 && line.x < kArrivedM && std::abs(line.y) < kBesideM &&
         std::abs(wrap_angle(heading - line.direction)) < kAlongRad;
}

Way way_on_line(const GoalLine& line) {
  Way way;
  way.direction = line.direction - std::clamp(4.0 * line.y, -0.3, 0.3);
  way.line_m = line.distance_m;
  return way;
}

// The arc ends at the goal along its direction, on the robot's side of the line through the goal (side = 1: left).
// If the robot is on a circle of a usable radius that is tangent to the goal's direction, the way is that arc alone;
// else a line tangent to the widest or the tightest usable circle comes before it.
Way way_along(const GoalLine& line, double side) {
  const double x = line.x, y = side * line.y, d = line.distance_m;
  Way way;
  const double on = y > 1e-6 ? d * d / (2.0 * y) : 1e3;  // radius of the circle through the robot
  const double radius = std::clamp(on, kTightM, kWideM);
  const Vector2 q{x, y - radius};  // from the circle's center, y towards the side
  const double reach = length(q);
  // The motion is counterclockwise around the center in these coordinates.
  double begin = 0.0;
  if (reach < radius * (1.0 - 1e-6)) {
    begin = bearing(perpendicular(q)) - 0.5 * pi * (1.0 - reach / radius);
    way.line_m = 3.0 * (radius - reach);
    way.arc_m = radius * (pi - std::copysign(0.5 * pi, -x));
    way.radius_m = radius;
  } else {
    begin = bearing(-q) - std::asin(std::min(1.0, radius / reach));
    way.line_m = std::sqrt(std::max(0.0, reach * reach - radius * radius));
    // Angle of the arc: the direction turns from `begin` to 0, counterclockwise.
    double turn = std::fmod(-begin, 2.0 * pi);
    if (turn < -1e-6) turn += 2.0 * pi;
    if (turn > 2.0 * pi - 0.05) turn = 0.0;
    way.arc_m = radius * std::max(0.0, turn);
    way.radius_m = radius;
    if (way.line_m < kLeadM) way.curvature = std::min(1.0, way.arc_m / kLeadM) * side / radius;
  }
  way.direction = line.direction + side * begin;
  return way;
}

Way straight_way(const Rover& robot, Vector2 place) {
  Way way;
  way.line_m = length(place - robot.position);
  way.direction = way.line_m > 1e-6 ? bearing(place - robot.position) : robot.heading;
  return way;
}

double curve_speed(double radius_m, const DriveParameters& limits) {
  const double wheel = limits.max_wheel_speed_mps / (1.0 + 0.5 * limits.wheel_base_m / radius_m);
  return std::min(
      {limits.max_speed_mps, std::sqrt(curve_grip(limits) * radius_m), wheel, limits.max_turn_radps * radius_m});
}

// Time on a way of this length that begins with a speed and accelerates to `top`.
double travel_time(double way_m, double speed, double top, double acceleration) {
  speed = std::clamp(speed, -top, top);
  const double ramp_m = (top * top - speed * speed) / (2.0 * acceleration);
  if (speed < 0.0) way_m += speed * speed / (2.0 * acceleration);
  if (way_m >= ramp_m) return (top - speed) / acceleration + (way_m - ramp_m) / top;
  return (std::sqrt(std::max(0.0, speed * std::abs(speed) + 2.0 * acceleration * way_m)) - speed) / acceleration;
}

// The part of the acceleration that plans use.
double accelerating(const DriveParameters& limits) { return 0.8 * limits.max_wheel_acceleration_mps2; }

struct Plan {
  double time_s = 1e9;
  bool backward = false;
  Way way;
};

double turn_time(double error, const DriveParameters& limits) {
  const double a = std::abs(error);
  // Turning on the spot is as fast as the drive allows; small errors are turned while driving.
  return a / (0.7 * limits.max_turn_radps) * std::min(1.0, a) +
         0.12 * std::max(0.0, std::sin(std::min(a, 0.5 * pi)) - 0.3);
}

// How far the farthest point of the arc is outside of the area in which the robot may be.
double arc_outside(const Way& way, double side, const GoalLine& line, Vector2 place, const MotionArea& area) {
  if (way.arc_m <= 0.3 * way.radius_m) return 0.0;
  const double sweep = std::min(2.0, way.arc_m / way.radius_m);
  return area.outside_m(place + (side * way.radius_m * (1.0 - std::cos(sweep))) * perpendicular(line.ahead) -
                        (way.radius_m * std::sin(std::min(sweep, 0.5 * pi))) * line.ahead);
}

// The fastest of the ways forward and backward, with the arc on each side.
class FastestWay {
 public:
  FastestWay(const MotionState& robot, const DriveParameters& limits, double after_s)
      : rover_(rover_of(robot, false, after_s)), limits_(limits) {}

  Plan find(const MotionGoal& goal, const MotionArea& area) {
    constexpr double kOutsideSPerM = 4.0;
    if (!goal.direction_rad) {
      const Way way = straight_way(rover_, goal.place);
      consider(way, false, 0.0);
      consider(way, true, 0.0);
      return best_;
    }
    const GoalLine line(rover_.position, goal);
    const std::array<bool, 2> on_line{is_on_line(line, rover_.heading), is_on_line(line, rover_.heading + pi)};
    for (const bool backward : {false, true}) {
      if (on_line[backward ? 1 : 0]) consider(way_on_line(line), backward, 0.0);
    }
    for (const double side : {1.0, -1.0}) {
      const Way way = way_along(line, side);
      const double extra_s = kOutsideSPerM * arc_outside(way, side, line, goal.place, area);
      for (const bool backward : {false, true}) {
        if (!on_line[backward ? 1 : 0]) consider(way, backward, extra_s);
      }
    }
    return best_;
  }

 private:
  void consider(const Way& way, bool backward, double extra_s) {
    const double error = wrap_angle(way.direction - rover_.heading + (backward ? pi : 0.0));
    const double top = way.arc_m > way.line_m ? curve_speed(way.radius_m, limits_) : limits_.max_speed_mps;
    const double speed = backward ? -rover_.speed : rover_.speed;
    const double time = extra_s + turn_time(error, limits_) +
                        travel_time(way.line_m + way.arc_m, speed * std::cos(error), top, accelerating(limits_));
    if (time < best_.time_s) best_ = {time, backward, way};
  }

  const Rover rover_;
  const DriveParameters& limits_;
  Plan best_;
};

}  // namespace

Twist drive_through(const MotionState& robot, const MotionGoal& goal, const DriveParameters& limits,
                    const MotionArea& area) {
  const Plan plan = FastestWay(robot, limits, kResponseS).find(goal, area);
  const Rover rover = rover_of(robot, plan.backward, kResponseS);
  const double error = wrap_angle(plan.way.direction - rover.heading);
  const double sign = plan.backward ? -1.0 : 1.0;
  // On the spot, as fast as the wheels can stop the turn again.
  const double turn_acceleration = 2.0 * limits.max_wheel_acceleration_mps2 / limits.wheel_base_m;
  const double turn = std::copysign(
      std::min({kTurnPerS * std::abs(error), std::sqrt(turn_acceleration * std::abs(error)), limits.max_turn_radps}),
      error);
  const double way = plan.way.line_m + plan.way.arc_m;
  double v = plan.way.curvature != 0.0 ? curve_speed(plan.way.radius_m, limits) : limits.max_speed_mps;
  // Ahead of an arc the robot slows down to the arc's speed.
  const double braking = 0.7 * limits.max_wheel_acceleration_mps2;
  if (plan.way.curvature == 0.0 && plan.way.arc_m > 0.5 * plan.way.radius_m) {
    const double arc = curve_speed(plan.way.radius_m, limits);
    v = std::min(v, std::sqrt(arc * arc + 2.0 * braking * plan.way.line_m));
  }
  if (goal.end_speed_mps < limits.max_speed_mps) {
    const double end = goal.end_speed_mps;
    v = std::min(v, std::max(end, std::min(std::sqrt(end * end + 2.0 * braking * way), 6.0 * way)));
  }
  const double off = std::min(std::abs(error), 0.5 * pi);
  v *= std::cos(off) * (off > 0.6 ? std::max(0.0, 1.0 - (off - 0.6)) : 1.0);
  // Grip and wheels: v * w <= grip; v + w b / 2 <= limit.
  const double w = std::abs(turn + v * plan.way.curvature);
  if (w > 1e-6)
    v = std::min(
        v, std::max(0.0, std::min(curve_grip(limits) / w, limits.max_wheel_speed_mps - 0.5 * limits.wheel_base_m * w)));
  return {static_cast<float>(sign * v), static_cast<float>(turn + v * plan.way.curvature)};
}

double least_time_through(const MotionState& robot, Vector2 place, const DriveParameters& limits) {
  // The shortest ways are straight. A way that begins inside the tightest circle counts as up to half a radius less.
  const double way = std::max(0.0, length(place - robot.place) - 0.5 * kTightM);
  return kResponseS + travel_time(way, std::abs(robot.v_mps), limits.max_speed_mps, accelerating(limits));
}

double time_through(const MotionState& robot, const MotionGoal& goal, const DriveParameters& limits,
                    const MotionArea& area) {
  return kResponseS + FastestWay(robot, limits, 0.0).find(goal, area).time_s;
}

}  // namespace touchline
