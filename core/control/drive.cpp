#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/control/skill_goal.h"
#include "core/geometry/angle.h"

namespace touchline {
namespace {

using std::numbers::pi;
// Sideways acceleration in a curve, in m/s^2: rubber tires slide between 5 and 8.
constexpr double kCurveGrip = 5.0;
// Wheels follow a command with a lag of 40 to 160 ms; a law for the pose at which the wheels have followed for the
// most part does not oscillate.
constexpr double kResponseS = 0.08;
constexpr double kTurnPerS = 25.0;
// The robot begins to turn so far before the arc, because its wheels lag, and ends so far before the arc's end.
constexpr double kLeadM = 0.04;
// Radii of the curve to the goal. With these, gain and response, the most of 150 resting balls were struck towards the
// goal (docs/control.md).
constexpr double kTightM = 0.06, kWideM = 0.18;

// A robot that drives ahead with either end.
struct Rover {
  Vector2 position;
  double heading = 0.0;  // of the motion
  double speed = 0.0;    // in this direction
};

Rover rover_of(const Player& robot, bool backward, double after_s) {
  const double v = static_cast<double>(robot.twist.v_mps), w = static_cast<double>(robot.twist.w_radps);
  const double middle = heading(robot.pose) + 0.5 * after_s * w;
  Rover out;
  out.position = position(robot.pose) + (after_s * v) * unit_vector(middle);
  out.heading = wrap_angle(heading(robot.pose) + after_s * w + (backward ? pi : 0.0));
  out.speed = backward ? -v : v;
  return out;
}

// The way from a robot to its goal: turn, line, arc.
struct Way {
  double direction = 0.0;  // in which it begins
  double curvature = 0.0;  // at its begin, 1/m
  double line_m = 0.0, arc_m = 0.0, radius_m = 1e3;
};

// The arc ends at the goal along its direction, on the robot's side of the line through the goal (side = 1: left).
// If the robot is on a circle of a usable radius that is tangent to the goal's direction, the way is that arc alone;
// else a line tangent to the widest or the tightest usable circle comes before it.
Way way_along(const Rover& robot, Vector2 place, double direction, double side) {
  const Vector2 ahead = unit_vector(direction), left = perpendicular(ahead), to = robot.position - place;
  const double x = dot(to, ahead), y = side * dot(to, left), d = norm(to);
  Way way;
  // At the place, or beyond it towards the ball: along the direction, with a correction towards the line.
  const double off = std::abs(wrap_angle(robot.heading - direction));
  if (x > -0.02 && x < kRunUpM + 0.05 && std::abs(y) < 0.03 && off < 0.6) {
    way.direction = direction - side * std::clamp(4.0 * y, -0.3, 0.3);
    way.line_m = d;
    return way;
  }
  const double on = y > 1e-6 ? d * d / (2.0 * y) : 1e3;  // radius of the circle through the robot
  const double radius = std::clamp(on, kTightM, kWideM);
  const Vector2 q{x, y - radius};  // from the circle's center, y towards the side
  const double reach = norm(q);
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
  way.direction = direction + side * begin;
  return way;
}

// Straight to a place at which the robot stops, or along a line through it.
Way way_to_stop(const Rover& robot, const SkillGoal& goal) {
  // The way back to the line is at most this steep, and less near the place, where the motion changes its direction.
  constexpr double kLineM = 0.15, kMaxTilt = 0.5, kTiltPerM = 6.0, kNearM = 0.06, kOnLineM = 0.012;
  const Vector2 to = goal.place - robot.position;
  Way way;
  way.line_m = norm(to);
  way.direction = way.line_m > 1e-6 ? bearing(to) : robot.heading;
  if (!goal.direction_rad) return way;
  const Vector2 line = unit_vector(*goal.direction_rad);
  const double along = dot(to, line), beside = cross(line, to);
  if (std::abs(beside) > kLineM) return way;
  // A robot beside the line moves to and fro around the place until it is on the line.
  const double left = std::abs(along) + (std::abs(beside) > kOnLineM ? std::abs(beside) : 0.0);
  const double near = std::min(1.0, left / kNearM);
  const double tilt = near * std::clamp(kTiltPerM * beside, -kMaxTilt, kMaxTilt);
  way.line_m = left;
  way.direction = along >= 0.0 ? *goal.direction_rad + tilt : *goal.direction_rad + pi - tilt;
  return way;
}

double curve_speed(double radius_m, const DriveParameters& limits) {
  const double wheel = limits.max_wheel_speed_mps / (1.0 + 0.5 * limits.wheel_base_m / radius_m);
  return std::min({limits.max_speed_mps, std::sqrt(kCurveGrip * radius_m), wheel, limits.max_turn_radps * radius_m});
}

// Time on a way of this length that begins with a speed and is not slower than `top` for long.
double travel_time(double way_m, double speed, double top, double acceleration) {
  speed = std::clamp(speed, -top, top);
  const double ramp_m = (top * top - speed * speed) / (2.0 * acceleration);
  if (speed < 0.0) way_m += speed * speed / (2.0 * acceleration);
  if (way_m >= ramp_m) return (top - speed) / acceleration + (way_m - ramp_m) / top;
  return (std::sqrt(std::max(0.0, speed * std::abs(speed) + 2.0 * acceleration * way_m)) - speed) / acceleration;
}

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

Plan plan_way(const Player& robot, const SkillGoal& goal, const Pitch& pitch, const DriveParameters& limits,
              double after_s) {
  Plan best;
  const double acceleration = 0.8 * limits.max_wheel_acceleration_mps2;
  for (const bool backward : {false, true}) {
    const Rover rover = rover_of(robot, backward, after_s);
    for (const double side : {1.0, -1.0}) {
      Way way;
      double extra = 0.0;
      if (goal.direction_rad && goal.end_speed_mps > 0.0) {
        way = way_along(rover, goal.place, *goal.direction_rad, side);
        // The arc's far point must be inside the field.
        if (way.arc_m > 0.3 * way.radius_m) {
          const Vector2 n = perpendicular(unit_vector(*goal.direction_rad));
          const double sweep = std::min(2.0, way.arc_m / way.radius_m);
          const Vector2 far = goal.place + (side * way.radius_m * (1.0 - std::cos(sweep))) * n -
                              (way.radius_m * std::sin(std::min(sweep, 0.5 * pi))) * unit_vector(*goal.direction_rad);
          const Vector2 in = pitch.inside(far, pitch.robot_m);
          extra = 4.0 * distance(in, far);
        }
      } else {
        way = way_to_stop(rover, goal);
      }
      const double error = wrap_angle(way.direction - rover.heading);
      const double top = way.arc_m > way.line_m ? curve_speed(way.radius_m, limits) : limits.max_speed_mps;
      double time = turn_time(error, limits) +
                    travel_time(way.line_m + way.arc_m, rover.speed * std::cos(error), top, acceleration) + extra;
      if (goal.end_speed_mps <= 0.0) time += 0.15;
      if (time < best.time_s) best = {time, backward, way};
      if (!goal.direction_rad) break;
    }
  }
  return best;
}

// The first obstacle on the line to the place, and a point beside it.
Vector2 around(Vector2 from, Vector2 velocity, const SkillGoal& goal, const RoundObstacles& obstacles,
               const Pitch& pitch) {
  const Vector2 way = goal.place - from;
  const double length = norm(way);
  if (length < 1e-6) return goal.place;
  const Vector2 ahead = (1.0 / length) * way;
  const double speed = std::max(0.4, norm(velocity));
  const RoundObstacle* blocking = nullptr;
  Vector2 there;
  double nearest = length;
  for (const RoundObstacle& obstacle : obstacles) {
    // Where it is when the robot comes by, at most 0.4 s later.
    const double meet = std::clamp(dot(obstacle.position - from, ahead) / speed, 0.0, 0.4);
    const Vector2 p = obstacle.position + meet * obstacle.velocity;
    const double along = dot(p - from, ahead), beside = cross(ahead, p - from);
    if (along <= 0.0 || along >= nearest || std::abs(beside) >= obstacle.clearance_m) continue;
    if (distance(p, goal.place) < 0.8 * obstacle.clearance_m) continue;
    nearest = along;
    blocking = &obstacle;
    there = p;
  }
  if (blocking == nullptr) return goal.place;
  const double side = cross(ahead, there - from) > 0.0 ? -1.0 : 1.0;
  const Vector2 offset = (1.1 * side * blocking->clearance_m) * perpendicular(ahead);
  const auto fits = [&](Vector2 p) { return distance(p, pitch.inside(p, 1.2 * pitch.robot_m)) < 1e-9; };
  return fits(there + offset) || !fits(there - offset) ? there + offset : there - offset;
}

Twist follow(const Player& robot, const Plan& plan, const SkillGoal& goal, const DriveParameters& limits) {
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
    v = std::min(v,
                 std::max(0.0, std::min(kCurveGrip / w, limits.max_wheel_speed_mps - 0.5 * limits.wheel_base_m * w)));
  return {static_cast<float>(sign * v), static_cast<float>(turn + v * plan.way.curvature)};
}

// A robot that must turn much but touches a wall or another robot leaves it first: its corners need room.
Twist freed(Twist twist, const Player& robot, double error, const RoundObstacles& obstacles, const Pitch& pitch) {
  constexpr double kMuchRad = 0.5, kAlong = 0.5, kLeaveMps = 0.4;
  if (std::abs(error) < kMuchRad) return twist;
  const Vector2 here = position(robot.pose);
  Vector2 away = pitch.away_from_walls(here);
  for (const RoundObstacle& obstacle : obstacles) {
    const Vector2 from = here - obstacle.position;
    const double d = norm(from);
    if (d > 1e-6 && d < 2.5 * pitch.robot_m) away = away + (1.0 / d) * from;
  }
  const double length = norm(away), along = dot(away, unit_vector(heading(robot.pose)));
  if (length < 1e-6 || std::abs(along) < kAlong * length) return twist;
  return {static_cast<float>(std::copysign(kLeaveMps, along)), 0.3f * twist.w_radps};
}

// Slows down in front of robots that have the right of way.
Twist braked(Twist twist, const Player& robot, const RoundObstacles& obstacles) {
  constexpr double kBrakePerS = 4.0;
  const Rover rover = rover_of(robot, twist.v_mps < 0.0f, kResponseS);
  for (const RoundObstacle& obstacle : obstacles) {
    if (obstacle.brake_m <= 0.0) continue;
    const Vector2 to = obstacle.position + kResponseS * obstacle.velocity - rover.position;
    const double d = norm(to), ahead = dot(to, unit_vector(rover.heading));
    if (d > 2.0 * obstacle.clearance_m || ahead < 0.6 * d) continue;
    const auto most = static_cast<float>(std::max(0.0, kBrakePerS * (d - obstacle.brake_m)));
    twist.v_mps = std::clamp(twist.v_mps, -most, most);
  }
  return twist;
}

}  // namespace

double time_to(const Player& robot, const SkillGoal& goal, const Pitch& pitch, const DriveParameters& limits) {
  return kResponseS + plan_way(robot, goal, pitch, limits, 0.0).time_s;
}

Twist drive(const Player& robot, const SkillGoal& goal, const RoundObstacles& obstacles, const Pitch& pitch,
            const DriveParameters& limits) {
  if (goal.twist) return braked(*goal.twist, robot, obstacles);
  const Rover rover = rover_of(robot, false, kResponseS);
  SkillGoal next = goal;
  next.place = around(rover.position, rover.speed * unit_vector(rover.heading), goal, obstacles, pitch);
  if (distance(next.place, goal.place) > 1e-9) {
    next.direction_rad.reset();
    next.end_speed_mps = limits.max_speed_mps;
  } else if (goal.end_speed_mps <= 0.0) {
    constexpr double kArrivedM = 0.012;
    const double left = distance(rover.position, goal.place);
    if (left < kArrivedM) {
      if (!goal.direction_rad) return {};
      const double ahead = wrap_angle(*goal.direction_rad - rover.heading);
      const double error = std::abs(ahead) > 0.5 * pi ? wrap_angle(ahead + pi) : ahead;
      return {0.0f, static_cast<float>(kTurnPerS * error)};
    }
  }
  const Plan plan = plan_way(robot, next, pitch, limits, kResponseS);
  const double error = wrap_angle(plan.way.direction - rover_of(robot, plan.backward, kResponseS).heading);
  const Twist twist = follow(robot, plan, next, limits);
  return braked(freed(twist, robot, error, obstacles, pitch), robot, obstacles);
}

}  // namespace touchline
