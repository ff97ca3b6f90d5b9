#include "core/supervision/motion_check.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace touchline {
namespace {

constexpr float kCertainMotion = 0.9f;
// A robot that was unseen for longer is judged anew.
constexpr double kLongestGap_s = 0.2;
// Time constants. The velocity's is several frames, and more than the lag of the wheels. The power's is so long that a
// single collision does not decide.
constexpr float kVelocity_s = 0.15f, kPower_s = 0.5f;
// Smallest commanded speeds at which a robot is judged: of both velocities together, and of one of them. At lower
// speeds, friction and noise of the sightings hide the motion.
constexpr float kMinSpeed_mps = 0.1f, kMinPart_mps = 0.05f;
// kStanding and kMoving are shares of the commanded power: a robot with less does not move, or hardly. kContradicting
// is a share of the commanded and seen power together. The error's share is 1 for a robot that moves independently of
// its commands, 2 for one that does the opposite, 0.1 for one that follows.
constexpr float kStanding = 0.04f, kMoving = 0.2f, kContradicting = 0.7f;
constexpr int kMinRobots = 2;
// No robot of the leagues is faster. A faster track has confused two robots.
constexpr float kFastest_mps = 5.0f;
constexpr double kContradicts_s = 0.3, kStands_s = 1.0;

float step_of(double dt_s, float time_constant_s) {
  const auto dt = static_cast<float>(dt_s);
  return dt / (time_constant_s + dt);
}

void approach(float& value, float other, float step) { value += step * (other - value); }

float square(float value) { return value * value; }

float turned_by(float from_rad, float to_rad) {
  return std::remainder(to_rad - from_rad, 2.0f * std::numbers::pi_v<float>);
}

}  // namespace

void MotionCheck::configure(double wheel_base_m, double wheel_lag_s) {
  lever_m_ = static_cast<float>(0.5 * wheel_base_m);
  wheel_lag_s_ = static_cast<float>(wheel_lag_s);
  restart();
}

void MotionCheck::restart() {
  robots_.clear();
  contradicts_ = stands_ = false;
}

bool MotionCheck::is_certain(const RobotSighting& robot) {
  return robot.team == Team::kOwn && robot.id != kUnknownId && robot.has_heading && robot.confidence >= kCertainMotion;
}

void MotionCheck::follow(const RobotSighting& sighting, Twist commanded, Instant now) {
  Robot* robot = std::find_if(robots_.begin(), robots_.end(), [&](const Robot& r) { return r.id == sighting.id; });
  if (robot == robots_.end()) {
    if (!robots_.push_back({})) return;
    robot = &robots_.back();
    robot->id = sighting.id;
  }
  const double dt_s = seconds(now - robot->seen_at);
  const Pose before = robot->pose;
  robot->pose = sighting.pose;
  robot->seen_at = now;
  if (dt_s <= 0.0) return;
  const auto dt = static_cast<float>(dt_s);
  const float way_m =
      std::hypot(sighting.pose.position.x_m - before.position.x_m, sighting.pose.position.y_m - before.position.y_m);
  if (dt_s > kLongestGap_s || way_m > kFastest_mps * dt) {
    *robot = {};
    robot->id = sighting.id;
    robot->seen_at = now;
    robot->pose = sighting.pose;
    return;
  }
  const float turn_rad = turned_by(before.theta_rad, sighting.pose.theta_rad);
  const float heading = before.theta_rad + 0.5f * turn_rad;
  const float ahead_m = (sighting.pose.position.x_m - before.position.x_m) * std::cos(heading) +
                        (sighting.pose.position.y_m - before.position.y_m) * std::sin(heading);
  const Velocity wanted{commanded.v_mps, lever_m_ * commanded.w_radps};
  const Velocity seen{ahead_m / dt, lever_m_ * turn_rad / dt};
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    approach(robot->wheels[i], wanted[i], step_of(dt_s, wheel_lag_s_));
    approach(robot->seen[i], seen[i], step_of(dt_s, kVelocity_s));
    approach(robot->commanded[i], robot->wheels[i], step_of(dt_s, kVelocity_s));
    const float step = step_of(dt_s, kPower_s);
    approach(robot->power[i].seen, square(robot->seen[i]), step);
    approach(robot->power[i].commanded, square(robot->commanded[i]), step);
    approach(robot->power[i].error, square(robot->seen[i] - robot->commanded[i]), step);
  }
}

bool MotionCheck::contradicts(const Power& power) {
  return std::max(power.seen, power.commanded) >= square(kMinPart_mps) &&
         power.error > kContradicting * (power.commanded + power.seen) && power.seen > kMoving * power.commanded;
}

MotionCheck::Result MotionCheck::judge(Instant now) {
  Result result;
  int seen = 0;
  for (const Robot& robot : robots_) {
    if (seconds(now - robot.seen_at) > kLongestGap_s) continue;
    ++seen;
    const auto& [linear, angular] = robot.power;
    if (linear.commanded + angular.commanded < square(kMinSpeed_mps)) continue;
    ++result.counts.commanded;
    const bool stands = linear.seen + angular.seen < kStanding * (linear.commanded + angular.commanded);
    result.counts.standing += stands ? 1 : 0;
    result.counts.contradicting += !stands && (contradicts(linear) || contradicts(angular)) ? 1 : 0;
  }
  const Counts& counts = result.counts;
  const bool contradicts = counts.contradicting >= kMinRobots && 4 * counts.contradicting >= 3 * counts.commanded;
  if (!contradicts || !contradicts_) contradicts_since_ = now;
  contradicts_ = contradicts;
  // Two robots are required, because in nearly every game one of several is blocked for a second.
  const bool is_enough = counts.commanded >= std::min(seen, kMinRobots) && counts.commanded > 0;
  const bool stands = is_enough && counts.standing == counts.commanded;
  if (!stands || !stands_) stands_since_ = now;
  stands_ = stands;
  result.contradicts = contradicts && seconds(now - contradicts_since_) >= kContradicts_s;
  result.stands = stands && seconds(now - stands_since_) >= kStands_s;
  return result;
}

}  // namespace touchline
