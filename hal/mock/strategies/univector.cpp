#include "hal/mock/strategies/univector.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/geometry/angle.h"
#include "hal/mock/strategies/drive_law.h"

namespace touchline::hal::mock {
namespace {

constexpr double kNoLimit = std::numeric_limits<double>::infinity();
constexpr double degrees(double angle) { return angle * std::numbers::pi / 180.0; }

}  // namespace

// With the direction theta of the field, its curvature phi = d(theta)/ds along the heading and the heading error e:
// w = v phi + k sqrt(|e|) sign(e), and v is the smallest of the speed at which the tires grip in this curve, the speed
// at which the faster wheel reaches its limit, and the approach speed.
template <class Direction>
Twist Univector::follow(const Player& player, Instant now, const Direction& direction, double approach_mps) {
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
  const double wheel = std::min(gains_.max_wheel_mps, max_wheel_mps());
  const double by_grip = bend > 1e-6   ? (std::sqrt(turn * turn + 4.0 * bend * grip) - turn) / (2.0 * bend)
                         : turn > 1e-6 ? grip / turn
                                       : kNoLimit;
  const double by_wheels = (2.0 * wheel - wheel_base_m() * turn) / (2.0 + wheel_base_m() * bend);
  const double v = std::max(0.0, std::min({by_grip, by_wheels, approach_mps}));
  return to_twist(motion.ahead * v, v * phi + omega);
}

void Univector::list_obstacles(const Player& player, const Scene& scene, Vector2 place, Obstacles& out) const {
  for (const RobotTrack& robot : scene.tracks.robots) {
    if (robot.team == Team::kOwn && robot.id == player.id) continue;
    const Vector2 p = position(robot.pose_at_action);
    if (distance(p, place) < 3.0 * radius_m()) continue;
    out.push_back({p, static_cast<double>(robot.twist_at_action.v_mps) * unit_vector(heading(robot.pose_at_action))});
  }
}

bool Univector::is_beside_wall(Vector2 ball) const {
  // UnBrain regards a ball as beside the wall within 0.12 m; a robot and half of another one fit there.
  const double beside = 3.2 * radius_m();
  return std::abs(ball.y) > half_width_m() - beside ||
         (std::abs(ball.x) > half_length_m() - beside && std::abs(ball.y) > half_goal_m());
}

FieldTarget Univector::target_at(Vector2 ball) const {
  FieldTarget target;
  target.radius_m *= scale();
  target.transition_m *= scale();
  Vector2 push = far_goal() - ball;
  if (is_beside_wall(ball)) {
    // Along the wall, away from the own goal and to the opponent's. The spiral comes from the inner side.
    const double outward = ball.y < 0.0 ? -1.0 : 1.0;
    const double beside = 3.2 * radius_m();
    if (ball.x > half_length_m() - beside) {
      push = {0.3, -outward};
    } else if (ball.x < -half_length_m() + beside && std::abs(ball.y) < half_width_m() - beside) {
      push = {0.0, outward};
    } else {
      push = {1.0, 0.0};
    }
    target.spirals = outward > 0.0 ? Spirals::kRight : Spirals::kLeft;
  }
  target.direction_rad = bearing(push);
  // UnBrain aims 30 mm behind the ball.
  const double offset = 0.8 * radius_m();
  target.place = inside(ball - offset * unit_vector(target.direction_rad), radius_m());
  return target;
}

Twist Univector::attack(const Player& player, const Scene& scene) {
  const Vector2 here = position(player.pose);
  // The ball when the robot reaches it; later it has probably hit somebody.
  constexpr double kMaxLead = 0.5;
  const double wheel = std::min(gains_.max_wheel_mps, max_wheel_mps());
  const double lead = std::min(kMaxLead, distance(here, scene.ball) / wheel);
  const Vector2 ball = inside(scene.ball + lead * scene.ball_velocity, 0.0);
  const FieldTarget target = target_at(ball);
  const Vector2 push = unit_vector(target.direction_rad), from_ball = here - ball;
  const double near = 2.3 * radius_m();  // UnBrain: 85 mm
  const bool beside_wall = is_beside_wall(ball);

  // UnBrain spins at a ball beside the wall that an opponent contests; in a corner nothing else moves it.
  if (beside_wall && distance(here, scene.ball) < near) {
    const bool corner = std::abs(ball.y) > half_width_m() - near && std::abs(ball.x) > half_length_m() - near;
    const bool contested = std::any_of(scene.tracks.robots.begin(), scene.tracks.robots.end(), [&](const auto& robot) {
      return robot.team == Team::kOpponent && distance(position(robot.pose_at_action), here) < 5.0 * radius_m();
    });
    if (corner || contested) return to_twist(0.0, std::copysign(max_turn_radps(), -here.y));
  }

  Motion& motion = motions_.of(player.id);
  const double in_front = dot(from_ball, push);
  if (motion.strikes) {
    motion.strikes = in_front < 2.7 * radius_m();  // UnBrain: until the robot is 0.10 m in front of the ball
  } else if (in_front < 0.0 && !beside_wall) {
    // The line through robot and ball crosses the goal line in the goal, or nearly, and the heading is along it.
    const double to_goal = half_length_m() - here.x, to_ball = ball.x - here.x;
    const double crossing = to_ball > 1e-3 ? here.y + to_goal / to_ball * (ball.y - here.y) : kNoLimit;
    const double off = wrap_angle(heading(player.pose) - bearing(far_goal() - ball));
    const double turn = std::abs(motion.ahead < 0.0 ? wrap_angle(off + std::numbers::pi) : off);
    motion.strikes = std::abs(crossing) < 1.25 * half_goal_m() && turn < degrees(30.0);
  }
  const Instant now = scene.tracks.capture_time;
  if (motion.strikes && !beside_wall) {
    // Straight to the ball when it is far, to the goal when it is near.
    const Vector2 to_goal = far_goal() - here, to_ball = ball - here;
    const double goal = norm(to_goal), way = norm(to_ball);
    const double aim = goal + way > 1e-6 ? bearing((goal / (goal + way)) * unit_vector(bearing(to_goal)) +
                                                   (way / (goal + way)) * unit_vector(bearing(to_ball)))
                                         : heading(player.pose);
    return follow(player, now, [&](Vector2) { return aim; }, kNoLimit);
  }
  Obstacles obstacles;
  list_obstacles(player, scene, target.place, obstacles);
  AvoidanceParameters avoidance;
  avoidance.width_m *= scale();
  avoidance.min_distance_m *= scale();
  const Vector2 velocity = static_cast<double>(player.twist.v_mps) * unit_vector(heading(player.pose));
  const auto direction = [&](Vector2 p) {
    return avoiding_direction(p, direction_to_target(p, target), velocity, {obstacles.data(), obstacles.size()},
                              avoidance);
  };
  // UnBrain: 10 d^2 + 0.8 m/s + twice the ball's speed.
  const double d = distance(here, target.place);
  return follow(player, now, direction, 10.0 * d * d + 0.8 + 2.0 * norm(scene.ball_velocity));
}

Vector2 Univector::place_of(std::size_t rank, Vector2 ball) const {
  const double inner = ball.y > 0.0 ? -1.0 : 1.0;
  Vector2 place;
  if (rank == 0) {
    place = ball + Vector2{-0.35 * scale(), 0.1 * scale() * inner};  // UnBrain's midfielder: 0.35 m behind the ball
  } else if (rank == 1) {
    place = own_goal() + 0.4 * (ball - own_goal());
  } else {
    // Two columns across the own half.
    const double row = static_cast<double>((rank - 2) / 2), side = rank % 2 == 0 ? inner : -inner;
    place = {-half_length_m() * (0.35 + 0.1 * row), side * half_width_m() * (0.65 - 0.15 * row)};
  }
  place.x = std::max(place.x, -half_length_m() + static_cast<double>(field().goal_width_m));
  return inside(place, 3.0 * radius_m());
}

Twist Univector::assist(const Player& player, const Scene& scene) {
  motions_.of(player.id).strikes = false;
  const Vector2 here = position(player.pose), place = place_of(roles().rank_of(player.id, scene.players), scene.ball);
  const double d = distance(here, place);
  if (d < radius_m()) return {};
  Obstacles obstacles;
  list_obstacles(player, scene, place, obstacles);
  obstacles.push_back({scene.ball, scene.ball_velocity});
  AvoidanceParameters avoidance;
  avoidance.width_m *= scale();
  avoidance.min_distance_m *= scale();
  const Vector2 velocity = static_cast<double>(player.twist.v_mps) * unit_vector(heading(player.pose));
  const auto direction = [&](Vector2 p) {
    return avoiding_direction(p, bearing(place - p), velocity, {obstacles.data(), obstacles.size()}, avoidance);
  };
  constexpr double kApproachPerS = 5.0;  // K_P of Neon FC (controller/uni_controller.py)
  return follow(player, scene.tracks.capture_time, direction, kApproachPerS * d);
}

Twist Univector::move(const Player& player, const Scene& scene) {
  if (!scene.ball_known) return {};
  return player.id == roles().attacker() ? attack(player, scene) : assist(player, scene);
}

Twist Univector::keep(const Player& player, const Scene& scene) {
  constexpr double kKeeperMps = 1.0;  // UnBrain's goalkeeper (src/control/goalKeeper.py)
  return guard_goal(player, scene, std::min({kKeeperMps, gains_.max_wheel_mps, max_wheel_mps()}));
}

}  // namespace touchline::hal::mock
