// Rules of the game in the mock world: kick-off, goals, free balls, touches, and the play of the opponents.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/geometry/angle.h"
#include "hal/mock/world.h"

namespace touchline::hal::mock {
namespace {

// A ball that has moved less than this is regarded as stationary.
constexpr double kStillM = 0.05;
// A robot this close to the ball touches it.
constexpr double kTouchM = 0.002;

}  // namespace

void World::kick_off() {
  // Draws a random point near the center, because from a fixed point two symmetric teams could block each other
  // forever. The area grows with each draw until the point is free of robots.
  constexpr int kDraws = 200;
  const double reach = parameters_.robot_side_m * std::numbers::sqrt2 / 2.0 + parameters_.ball_radius_m;
  Vector2 point;
  for (int draw = 0; draw < kDraws; ++draw) {
    const double wider = 0.2 * draw / kDraws;
    const double x = std::min(0.02 + wider, 0.25 * parameters_.field.length_m);
    const double y = std::min(0.05 + wider, 0.25 * parameters_.field.width_m);
    point = {random_.uniform(-x, x), random_.uniform(-y, y)};
    const auto is_near = [&](const Robot& robot) { return length(robot.body.position - point) < reach; };
    if (std::none_of(robots_.begin(), robots_.end(), is_near)) break;
  }
  place_ball({point.x, point.y, 0.0});
}

void World::count_ball_touches() {
  const Circle grown{&ball_, parameters_.ball_radius_m + kTouchM};
  for (Robot& robot : robots_) {
    contacts_.clear();
    collide(grown, square(robot), {}, contacts_);
    const bool touches = !contacts_.empty();
    if (touches && !robot.touches_ball && robot.team == Side::kOwn) ++statistics_.touches;
    robot.touches_ball = touches;
  }
}

void World::referee() {
  const double goal_line = 0.5 * parameters_.field.length_m + parameters_.ball_radius_m;
  if (std::abs(ball_.position.x) > goal_line) {
    ++(ball_.position.x > 0.0 ? statistics_.goals_own : statistics_.goals_opponent);
    kick_off();
    return;
  }
  if (length(ball_.position - still_at_) > kStillM) {
    still_at_ = ball_.position;
    still_s_ = 0.0;
    return;
  }
  // If neither opponents play nor an own robot gets commands, the ball stays where somebody has put it.
  const bool is_played = parameters_.opponents == Opponents::kPlay ||
                         std::any_of(robots_.begin(), robots_.end(),
                                     [](const Robot& robot) { return robot.commanded_mps != std::array<double, 2>{}; });
  if (!is_played) return;
  still_s_ += kStepS;
  if (still_s_ > parameters_.physics.free_ball_after_s) {
    ++statistics_.free_balls;
    kick_off();
  }
}

void World::play_opponents() {
  const Robot* nearest = nullptr;
  const Robot* keeper = nullptr;
  double least = 0.0;
  for (const Robot& robot : robots_) {
    if (robot.team == Side::kOwn) continue;
    if (keeper == nullptr) {
      keeper = &robot;
      continue;
    }
    const double distance = length(robot.body.position - ball_.position);
    if (nearest == nullptr || distance < least) {
      nearest = &robot;
      least = distance;
    }
  }
  for (Robot& robot : robots_) {
    if (robot.team == Side::kOwn) continue;
    if (&robot == keeper) {
      const double reach = 0.5 * parameters_.field.goal_width_m;
      robot.target = {0.5 * parameters_.field.length_m - parameters_.robot_side_m,
                      std::clamp(ball_.position.y, -reach, reach)};
    }
    play_opponent(robot, &robot == nearest);
  }
}

void World::play_opponent(Robot& robot, bool is_nearest) {
  robot.decide_in_s -= kStepS;
  if (robot.decide_in_s <= 0.0) {
    robot.decide_in_s = random_.uniform(1.0, 3.0);
    robot.target = {random_.uniform(-0.1, 0.4) * parameters_.field.length_m,
                    random_.uniform(-0.4, 0.4) * parameters_.field.width_m};
  }
  const Vector2 way = (is_nearest ? ball_.position : robot.target) - robot.body.position;
  const double distance = length(way);
  const double bearing = distance > 0.0 ? std::atan2(way.y, way.x) - robot.body.theta : 0.0;
  // Drives forward or backward, whichever needs the smaller turn.
  const double ahead = std::abs(wrap_angle(bearing)) <= 0.5 * std::numbers::pi ? 1.0 : -1.0;
  const double off = wrap_angle(ahead > 0.0 ? bearing : bearing + std::numbers::pi);
  const double near = std::min(1.0, distance / 0.1);
  const double speed = ahead * near * std::cos(off) * parameters_.opponent_speed_mps;
  const double turn = near * std::clamp(4.0 * off, -4.0, 4.0);
  const double half_base = 0.5 * parameters_.physics.wheel_base_m;
  robot.commanded_mps = {speed - turn * half_base, speed + turn * half_base};
}

}  // namespace touchline::hal::mock
