#include "hal/mock/strategies/univector_team.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/geometry/angle.h"

namespace touchline::hal::mock {
namespace {

constexpr double kNoLimit = std::numeric_limits<double>::infinity();
constexpr double degrees(double angle) { return angle * std::numbers::pi / 180.0; }

}  // namespace

// With the direction theta of the field, its curvature phi = d(theta)/ds along the heading and the heading error e:
// w = v phi + k sqrt(|e|) sign(e), and v is the smallest of the speed at which the tires grip in this curve, the speed
// at which the faster wheel reaches its limit, and the approach speed.
template <class Direction>
Twist UnivectorTeam::follow(const Player& player, Instant now, const Direction& direction, double approach_mps) {
  const Vector2 here = position(player.pose);
  const double field = direction(here);
  Motion& motion = motions_.of(player.id);
  const auto error_of = [&](double ahead) {
    return wrap_angle(field - heading(player.pose) - (ahead < 0.0 ? std::numbers::pi : 0.0));
  };
  // UnBrain reverses an attacker whose error exceeds 120 degrees, at most every 0.5 s.
  constexpr double kPause = 0.5;
  if (std::abs(error_of(motion.ahead)) > degrees(120.0) && seconds(now - motion.reversed) > kPause) {
    motion.ahead = -motion.ahead;
    motion.reversed = now;
  }
  const double error = error_of(motion.ahead);
  // UnBrain limits the derivatives to 15 rad/m as well; the field turns on the spot in its center.
  constexpr double kStep = 0.001, kMaxCurvature = 15.0;
  const Vector2 step = kStep * unit_vector(heading(player.pose) + (motion.ahead < 0.0 ? std::numbers::pi : 0.0));
  const double change = wrap_angle(direction(here + step) - direction(here - step));
  const double phi = std::clamp(change / (2.0 * kStep), -kMaxCurvature, kMaxCurvature);

  constexpr double kGravity = 9.81;
  const double omega = std::copysign(gains_.turn_gain * std::sqrt(std::abs(error)), error);
  const double turn = std::abs(omega), bend = std::abs(phi), grip = gains_.grip * kGravity;
  const double wheel = wheel_limit_mps();
  const double by_grip = bend > 1e-6   ? (std::sqrt(turn * turn + 4.0 * bend * grip) - turn) / (2.0 * bend)
                         : turn > 1e-6 ? grip / turn
                                       : kNoLimit;
  const double by_wheels = (2.0 * wheel - wheel_base_m() * turn) / (2.0 + wheel_base_m() * bend);
  const double v = std::max(0.0, std::min({by_grip, by_wheels, approach_mps}));
  return to_twist(motion.ahead * v, v * phi + omega);
}

void UnivectorTeam::list_obstacles(const Player& player, const Scene& scene, Vector2 place, Obstacles& out) const {
  for (const RobotTrack& robot : scene.tracks.robots) {
    if (robot.team == Team::kOwn && robot.id == player.id) continue;
    const Vector2 p = position(robot.pose_at_action);
    if (distance(p, place) < 3.0 * radius_m()) continue;
    out.push_back({p, static_cast<double>(robot.twist_at_action.v_mps) * unit_vector(heading(robot.pose_at_action))});
  }
}

double UnivectorTeam::around(Vector2 p, double direction_rad, const Player& player, const Obstacles& obstacles) const {
  AvoidanceParameters avoidance;
  avoidance.width_m *= scale();
  avoidance.min_distance_m *= scale();
  const Vector2 velocity = static_cast<double>(player.twist.v_mps) * unit_vector(heading(player.pose));
  return avoiding_direction(p, direction_rad, velocity, {obstacles.data(), obstacles.size()}, avoidance);
}

double UnivectorTeam::wheel_limit_mps() const { return std::min(gains_.max_wheel_mps, max_wheel_mps()); }

bool UnivectorTeam::is_beside_wall(Vector2 ball) const {
  return std::abs(ball.y) > half_width_m() - beside_m() ||
         (std::abs(ball.x) > half_length_m() - beside_m() && std::abs(ball.y) > half_goal_m());
}

FieldTarget UnivectorTeam::target_at(Vector2 ball) const {
  FieldTarget target;
  target.radius_m *= scale();
  target.transition_m *= scale();
  Vector2 push = far_goal() - ball;
  if (is_beside_wall(ball)) {
    // Along the wall, away from the own goal and to the opponent's. The spiral comes from the inner side.
    const double outward = ball.y < 0.0 ? -1.0 : 1.0;
    if (ball.x > half_length_m() - beside_m()) {
      push = {0.3, -outward};
    } else if (ball.x < -half_length_m() + beside_m() && std::abs(ball.y) < half_width_m() - beside_m()) {
      push = {0.0, outward};
    } else {
      push = {1.0, 0.0};
    }
    target.spirals = outward > 0.0 ? Spirals::kRight : Spirals::kLeft;
  }
  target.direction_rad = bearing(push);
  constexpr double kOffset = 0.03;  // UnBrain's target is 30 mm behind the ball.
  target.place = inside(ball - kOffset * scale() * unit_vector(target.direction_rad), radius_m());
  return target;
}

bool UnivectorTeam::is_in_corner(Vector2 ball) const {
  return std::abs(ball.y) > half_width_m() - touching_m() && std::abs(ball.x) > half_length_m() - touching_m();
}

bool UnivectorTeam::is_contested(Vector2 robot, const Scene& scene) const {
  const double contested = 0.2 * scale();  // UnBrain
  const auto& robots = scene.tracks.robots;
  return std::any_of(robots.begin(), robots.end(), [&](const RobotTrack& other) {
    return other.team == Team::kOpponent && distance(position(other.pose_at_action), robot) < contested;
  });
}

// UnBrain's conditions: the robot is behind the ball, the line through both crosses the goal line in the goal or within
// 50 mm of it, and the heading differs from the direction to the goal by at most 30 degrees.
bool UnivectorTeam::begins_strike(const Player& player, double ahead, Vector2 ball) const {
  const Vector2 here = position(player.pose), way = ball - here, to_goal = far_goal() - ball;
  if (dot(way, to_goal) <= 0.0 || way.x < 1e-3) return false;
  const double crossing = here.y + (half_length_m() - here.x) / way.x * way.y;
  const double front = heading(player.pose) + (ahead < 0.0 ? std::numbers::pi : 0.0);
  return std::abs(crossing) < half_goal_m() + 0.05 * scale() &&
         std::abs(wrap_angle(front - bearing(to_goal))) < degrees(30.0);
}

Twist UnivectorTeam::strike(const Player& player, Instant now, Vector2 ball) {
  const Vector2 here = position(player.pose), to_goal = far_goal() - here, to_ball = ball - here;
  const double goal = norm(to_goal), way = norm(to_ball);
  const double aim = bearing(goal * unit_vector(bearing(to_goal)) + way * unit_vector(bearing(to_ball)));
  return follow(
      player, now, [aim](Vector2) { return aim; }, kNoLimit);
}

Twist UnivectorTeam::attack(const Player& player, const Scene& scene, Avoid avoid) {
  const Vector2 here = position(player.pose);
  // The ball when the robot reaches it; after a longer time it has probably hit somebody.
  constexpr double kMaxLead = 0.5;
  const double lead = std::min(kMaxLead, distance(here, scene.ball) / wheel_limit_mps());
  const Vector2 ball = inside(scene.ball + lead * scene.ball_velocity, 0.0);
  const Instant now = scene.tracks.capture_time;
  Motion& motion = motions_.of(player.id);
  // UnBrain spins at a contested ball beside a wall. In a corner, no spiral leads behind the ball, and only spinning
  // moves it out.
  const bool corner = is_in_corner(scene.ball);
  if (corner || (is_beside_wall(scene.ball) && is_contested(here, scene))) {
    motion.strikes = false;
    if (distance(here, scene.ball) < touching_m()) return to_twist(0.0, std::copysign(max_turn_radps(), -here.y));
    if (corner)
      return follow(
          player, now, [&](Vector2 p) { return bearing(scene.ball - p); }, kNoLimit);
  }
  const FieldTarget target = target_at(ball);
  if (is_beside_wall(ball)) {
    motion.strikes = false;
  } else if (motion.strikes) {
    // UnBrain ends a strike when the robot is 0.10 m in front of the ball.
    motion.strikes = dot(here - ball, unit_vector(target.direction_rad)) < 0.10 * scale();
  } else {
    motion.strikes = begins_strike(player, motion.ahead, ball);
  }
  if (motion.strikes) return strike(player, now, ball);

  Obstacles obstacles;
  if (avoid == Avoid::kRobots) list_obstacles(player, scene, target.place, obstacles);
  const auto direction = [&](Vector2 p) { return around(p, direction_to_target(p, target), player, obstacles); };
  // UnBrain: 10 d^2 + 0.8 m/s + twice the ball's speed.
  const double d = distance(here, target.place);
  return follow(player, now, direction, 10.0 * d * d + 0.8 + 2.0 * norm(scene.ball_velocity));
}

Twist UnivectorTeam::go_to(const Player& player, const Scene& scene, Vector2 place) {
  motions_.of(player.id).strikes = false;
  const double d = distance(position(player.pose), place);
  if (d < radius_m()) return {};
  Obstacles obstacles;
  list_obstacles(player, scene, place, obstacles);
  obstacles.push_back({scene.ball, scene.ball_velocity});
  const auto direction = [&](Vector2 p) { return around(p, bearing(place - p), player, obstacles); };
  constexpr double kApproachPerS = 5.0;  // K_P of Neon FC (controller/uni_controller.py)
  return follow(player, scene.tracks.capture_time, direction, kApproachPerS * d);
}

Twist UnivectorTeam::keep(const Player& player, const Scene& scene) {
  constexpr double kKeeperMps = 1.0;  // UnBrain's goalkeeper (src/control/goalKeeper.py)
  return guard_goal(player, scene, std::min(kKeeperMps, wheel_limit_mps()));
}

}  // namespace touchline::hal::mock
