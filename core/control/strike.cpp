#include "core/control/strike.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/geometry/angle.h"

namespace touchline {
namespace {

using std::numbers::pi;
// Mean speed at which a ball comes nearer to the goal in a game, and what each further contact costs.
constexpr double kAdvanceMps = 0.7, kContactS = 0.6;

// Time that remains with the ball at rest at p.
double rest_time(Vector2 p, const Pitch& pitch) {
  const Vector2 to = pitch.far_goal() - p;
  const double d = norm(to);
  const double slant = d > 1e-6 ? 1.0 - to.x / d : 0.0;  // 0 in front of the goal, 1 beside it
  return kContactS + d / kAdvanceMps + 0.5 * slant;
}

// Lower bound of time_to_goal(): the ball is not slower than kAdvanceMps for long, and not faster than now.
double least_time_to_goal(const BallState& ball, const Pitch& pitch) {
  const Vector2 to{std::max(0.0, pitch.end_m - ball.position.x),
                   std::max(0.0, std::abs(ball.position.y) - pitch.mouth_m)};
  return std::sqrt(dot(to, to)) / std::max(kAdvanceMps, std::sqrt(dot(ball.velocity, ball.velocity)));
}

// A robot that strikes is this fast at the ball, as a part of its maximum: the mean of undisturbed strikes.
constexpr double kStrikeShare = 0.85;

BallState after_strike(const BallState& ball, double direction_rad, const Scene& scene) {
  return struck(ball, direction_rad, kStrikeShare * scene.parameters.drive.max_speed_mps, scene.pitch.rolling);
}

}  // namespace

double time_to_goal(BallState ball, const Scene& scene) {
  constexpr double kStep = 0.1, kHorizon = 1.6;
  constexpr double kLost = 0.5, kOwnGoal = 10.0, kOwnArea = 1.0;
  const Pitch& pitch = scene.pitch;
  if (ball.position.x > pitch.end_m) return 0.0;  // it is there already
  double danger = 0.0;
  const bool was_in_area = pitch.in_own_area(ball.position, 0.0);
  constexpr int kSteps = static_cast<int>(kHorizon / kStep);
  constexpr double kReach = 0.055, kMaxReach = kReach + 0.12;
  // Until then an opponent is too far away to reach the ball: most are so all the time.
  std::array<double, kMaxRobots> far_until{};
  for (int i = 0; i < kSteps; ++i) {
    const double t = i * kStep;
    const Vector2 from = ball.position;
    const double speed = std::sqrt(dot(ball.velocity, ball.velocity));  // which becomes only less
    // A wall so near leaves the ball no way back: the robot behind it keeps it there.
    BallState next = rolled(ball, kStep, pitch);
    if (t < 0.5 * kStep && dot(next.velocity, ball.velocity) < 0.5 * dot(ball.velocity, ball.velocity))
      next.velocity = {};
    ball = next;
    // Opponents move towards the ball while it rolls.
    const double reach = std::min(kMaxReach, kReach + 0.3 * std::max(0.0, t - 0.1));
    const Vector2 way = ball.position - from;
    const double length2 = dot(way, way);
    for (std::size_t k = 0; k < scene.opponents.size(); ++k) {
      if (t < far_until[k]) continue;
      const Opponent& opponent = scene.opponents[k];
      const Vector2 p = opponent.position + t * opponent.velocity;
      const double part = length2 > 1e-12 ? std::clamp(dot(p - from, way) / length2, 0.0, 1.0) : 0.0;
      const Vector2 off = from + part * way - p;
      const double off2 = dot(off, off);
      if (t + part * kStep > 0.05 && off2 < reach * reach) {
        return danger + t + kLost + rest_time(from + part * way, pitch);
      }
      const double spare = std::sqrt(off2) - kMaxReach - kStep * speed;
      if (spare > 0.0) far_until[k] = t + spare / (speed + opponent.speed_mps + 1e-6);
    }
    if (ball.position.x > pitch.end_m) {
      return danger + t + kStep * (pitch.end_m - from.x) / (ball.position.x - from.x);
    }
    if (ball.position.x < -pitch.end_m) return danger + kOwnGoal;
    if (!was_in_area && pitch.in_own_area(ball.position, 0.0)) danger = kOwnArea;
  }
  return danger + kHorizon + rest_time(ball.position, pitch);
}

BallState struck(BallState ball, double normal_rad, double speed_mps, const BallMotionParameters& parameters) {
  const Vector2 n = unit_vector(normal_rad);
  const double closing = speed_mps - dot(ball.velocity, n);
  // Conservation of momentum.
  const double transfer = (1.0 + parameters.robot_restitution) / (1.0 + parameters.mass_ratio);
  if (closing > 0.0) ball.velocity = ball.velocity + (transfer * closing) * n;
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
  options_.push_back(
      {ball, from_s, direction_rad, shifted, least_time_to_goal(after_strike(ball, direction_rad, scene), pitch)});
}

void StrikeOptions::complete(Option& option, const Scene& scene) {
  if (!option.is_bound) return;
  option.after_s = time_to_goal(after_strike(option.ball, option.direction_rad, scene), scene);
  option.is_bound = false;
}

void StrikeOptions::find(const Scene& scene) {
  options_.clear();
  const Pitch& pitch = scene.pitch;
  constexpr double kTimeStep = 0.15, kResting = 0.1;
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
        const BallState after = after_strike(ball, normal, scene);
        normal = wrap_angle(normal + std::clamp(wrap_angle(wanted - bearing(after.velocity)), -0.5, 0.5));
      }
      add(ball, t, normal, scene);
    }
    for (std::size_t k = 0; k < kRound; ++k)
      add(ball, t, wrap_angle(2.0 * pi * static_cast<double>(k) / kRound), scene);
  }
}

Strike StrikeOptions::best_for(const Player& robot, const double* former, const Scene& scene) {
  constexpr double kKeepS = 0.12, kKeepRad = 0.3, kLateS = 0.04;
  const DriveParameters& limits = scene.parameters.drive;
  const Vector2 here = position(robot.pose);
  // An opponent that is earlier changes everything.
  const auto disturbed_s = [&](double contact_s) { return 0.5 * std::max(0.0, contact_s - scene.opponent_at_ball_s); };
  Strike best;
  // Straight at the ball, whatever comes of it.
  const BallState ball = scene.path.at(distance(scene.ball, here) / limits.max_speed_mps);
  const double straight = bearing(ball.position - here);
  SkillGoal goal;
  goal.place = scene.pitch.inside(ball.position - scene.pitch.contact_m() * unit_vector(straight), scene.pitch.robot_m);
  goal.direction_rad = straight;
  goal.end_speed_mps = limits.max_speed_mps;
  const double straight_s = time_to(robot, goal, scene.pitch, limits);
  best = {goal, ball.position, straight, straight_s,
          straight_s + disturbed_s(straight_s) + time_to_goal(after_strike(ball, straight, scene), scene)};

  // The options in the order of their lower bounds, until none can be better.
  constexpr double kNever = 1e9;
  std::array<double, kTimes*(kAims + kRound)> soonest, bound;
  for (std::size_t i = 0; i < options_.size(); ++i) {
    const Option& option = options_[i];
    const double least = least_time_to(robot, option.place, limits);
    const bool rolls = dot(option.ball.velocity, option.ball.velocity) > 0.01;
    soonest[i] = std::max(option.from_s, least);
    bound[i] = rolls && least > option.from_s + kLateS ? kNever : soonest[i] + option.after_s;
  }
  while (options_.size() > 0) {
    const auto next = static_cast<std::size_t>(
        std::min_element(bound.begin(), bound.begin() + static_cast<std::ptrdiff_t>(options_.size())) - bound.begin());
    if (bound[next] > best.cost_s + kKeepS || bound[next] >= kNever) break;
    Option& option = options_[next];
    if (option.is_bound) {
      complete(option, scene);
      bound[next] = soonest[next] + option.after_s;
      continue;
    }
    bound[next] = kNever;
    goal.place = option.place;
    goal.direction_rad = option.direction_rad;
    const double time_s = time_to(robot, goal, scene.pitch, limits);
    if (dot(option.ball.velocity, option.ball.velocity) > 0.01 && time_s > option.from_s + kLateS) continue;
    const double contact_s = std::max(time_s, option.from_s);
    double cost = contact_s + option.after_s + disturbed_s(contact_s);
    if (former != nullptr && std::abs(wrap_angle(option.direction_rad - *former)) < kKeepRad) cost -= kKeepS;
    if (cost < best.cost_s) best = {goal, option.ball.position, option.direction_rad, contact_s, cost};
  }
  return best;
}

}  // namespace touchline
