#include "core/control/strike.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/geometry/angle.h"

namespace touchline {
namespace {

using std::numbers::pi;
// A robot of 0.45 kg gives a golf ball of 46 g (restitution 0.6) this part of the difference of their velocities.
constexpr double kTransfer = 1.45;
// Mean speed at which a ball comes nearer to the goal in a game, and what each further contact costs.
constexpr double kAdvanceMps = 0.7, kContactS = 0.6;

// Time that remains with the ball at rest at p.
double rest_time(Vector2 p, const Pitch& pitch) {
  const Vector2 to = pitch.far_goal() - p;
  const double d = norm(to);
  const double slant = d > 1e-6 ? 1.0 - to.x / d : 0.0;  // 0 in front of the goal, 1 beside it
  return kContactS + d / kAdvanceMps + 0.5 * slant;
}

}  // namespace

double time_to_goal(BallState ball, const Scene& scene) {
  constexpr double kStep = 0.1, kHorizon = 1.6;
  constexpr double kLost = 0.5, kOwnGoal = 10.0, kOwnArea = 1.0;
  const Pitch& pitch = scene.pitch;
  if (ball.position.x > pitch.end_m) return 0.0;  // it is there already
  double danger = 0.0;
  const bool was_in_area = pitch.in_own_area(ball.position, 0.0);
  const Rolling rolling(kStep);
  constexpr int kSteps = static_cast<int>(kHorizon / kStep);
  for (int i = 0; i < kSteps; ++i) {
    const double t = i * kStep;
    const Vector2 from = ball.position;
    // A wall so near leaves the ball no way back: the robot behind it keeps it there.
    BallState next = rolling.after(ball, pitch);
    if (t < 0.5 * kStep && dot(next.velocity, ball.velocity) < 0.5 * dot(ball.velocity, ball.velocity))
      next.velocity = {};
    ball = next;
    // Opponents move towards the ball while it rolls.
    const double reach = 0.055 + std::min(0.12, 0.3 * std::max(0.0, t - 0.1));
    const Vector2 way = ball.position - from;
    const double length2 = dot(way, way);
    for (const Opponent& opponent : scene.opponents) {
      const Vector2 p = opponent.position + t * opponent.velocity;
      const double part = length2 > 1e-12 ? std::clamp(dot(p - from, way) / length2, 0.0, 1.0) : 0.0;
      const Vector2 off = from + part * way - p;
      if (t + part * kStep > 0.05 && dot(off, off) < reach * reach) {
        return danger + t + kLost + rest_time(from + part * way, pitch);
      }
    }
    if (ball.position.x > pitch.end_m) {
      return danger + t + kStep * (pitch.end_m - from.x) / (ball.position.x - from.x);
    }
    if (ball.position.x < -pitch.end_m) return danger + kOwnGoal;
    if (!was_in_area && pitch.in_own_area(ball.position, 0.0)) danger = kOwnArea;
  }
  return danger + kHorizon + rest_time(ball.position, pitch);
}

BallState struck(BallState ball, double normal_rad, double speed_mps) {
  const Vector2 n = unit_vector(normal_rad);
  const double closing = speed_mps - dot(ball.velocity, n);
  if (closing > 0.0) ball.velocity = ball.velocity + (kTransfer * closing) * n;
  return ball;
}

void StrikeOptions::add(BallState ball, double from_s, double direction_rad, const Scene& scene) {
  const Pitch& pitch = scene.pitch;
  const Vector2 n = unit_vector(direction_rad);
  const Vector2 place = ball.position - (pitch.contact_m() + kRunUpM) * n;
  // Near a wall the robot hits the ball beside the middle of its side, as far as the ball is still in front of it.
  const double extent = pitch.robot_m * (std::abs(n.x) + std::abs(n.y)) + 0.003;
  const Vector2 shifted = pitch.inside(place, extent);
  const Vector2 shift = shifted - place;
  if (std::abs(cross(n, shift)) > 0.75 * pitch.robot_m || dot(n, shift) > kRunUpM || dot(n, shift) < -0.01) return;
  const double speed = 0.85 * scene.parameters.drive.max_speed_mps;
  options_.push_back({ball, from_s, direction_rad, shifted, time_to_goal(struck(ball, direction_rad, speed), scene)});
}

void StrikeOptions::find(const Scene& scene) {
  options_.clear();
  const Pitch& pitch = scene.pitch;
  constexpr double kTimeStep = 0.15, kResting = 0.1;
  const double speed = 0.85 * scene.parameters.drive.max_speed_mps;
  const bool rests = norm(scene.ball_velocity) < kResting;
  for (std::size_t i = 0; i < (rests ? 1 : kTimes); ++i) {
    const double t = kTimeStep * static_cast<double>(i);
    const BallState ball = scene.path.at(t);
    if (std::abs(ball.position.x) > pitch.end_m) break;
    for (std::size_t k = 0; k < kAims; ++k) {
      const double y = (static_cast<double>(k) / (kAims - 1) - 0.5) * 1.7 * (pitch.mouth_m - pitch.ball_m);
      const double wanted = bearing(Vector2{pitch.end_m, y} - ball.position);
      double normal = wanted;
      // The ball keeps its velocity along the robot's side.
      for (int round = 0; round < 2; ++round) {
        const BallState after = struck(ball, normal, speed);
        normal = wrap_angle(normal + std::clamp(wrap_angle(wanted - bearing(after.velocity)), -0.5, 0.5));
      }
      add(ball, t, normal, scene);
    }
    for (std::size_t k = 0; k < kRound; ++k)
      add(ball, t, wrap_angle(2.0 * pi * static_cast<double>(k) / kRound), scene);
  }
}

Strike StrikeOptions::best_for(const Player& robot, const double* former, const Scene& scene) const {
  constexpr double kKeepS = 0.12, kKeepRad = 0.3, kLateS = 0.04;
  const DriveParameters& limits = scene.parameters.drive;
  Strike best;
  const Vector2 here = position(robot.pose);
  for (const Option& option : options_) {
    // The straight way at full speed is a lower bound of the time.
    const Vector2 to = option.place - here;
    const double least = std::sqrt(dot(to, to)) / limits.max_speed_mps;
    if (std::max(option.from_s, least) + option.after_s > best.cost_s + kKeepS) continue;
    const bool rolls = dot(option.ball.velocity, option.ball.velocity) > 0.01;
    if (rolls && least > option.from_s + kLateS) continue;
    SkillGoal goal;
    goal.place = option.place;
    goal.direction_rad = option.direction_rad;
    goal.end_speed_mps = limits.max_speed_mps;
    const double t = time_to(robot, goal, scene.pitch, limits);
    if (rolls && t > option.from_s + kLateS) continue;
    const double contact = std::max(t, option.from_s);
    double cost = contact + option.after_s;
    // An opponent that is earlier changes everything.
    cost += 0.5 * std::max(0.0, contact - scene.opponent_at_ball_s);
    if (former != nullptr && std::abs(wrap_angle(option.direction_rad - *former)) < kKeepRad) cost -= kKeepS;
    if (cost < best.cost_s) best = {goal, option.ball.position, option.direction_rad, contact, cost};
  }
  // Straight at the ball, whatever comes of it.
  const BallState ball = scene.path.at(std::sqrt(dot(scene.ball - here, scene.ball - here)) / limits.max_speed_mps);
  const double straight = bearing(ball.position - here);
  SkillGoal goal;
  goal.place = scene.pitch.inside(ball.position - scene.pitch.contact_m() * unit_vector(straight), scene.pitch.robot_m);
  goal.direction_rad = straight;
  goal.end_speed_mps = limits.max_speed_mps;
  const double contact = time_to(robot, goal, scene.pitch, limits);
  const double cost = contact + 0.5 * std::max(0.0, contact - scene.opponent_at_ball_s) +
                      time_to_goal(struck(ball, straight, 0.85 * limits.max_speed_mps), scene);
  if (cost < best.cost_s) best = {goal, ball.position, straight, contact, cost};
  return best;
}

}  // namespace touchline
