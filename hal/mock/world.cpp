#include "hal/mock/world.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/geometry/angle.h"
#include "hal/mock/fnv1a.h"

namespace touchline::hal::mock {
namespace {

constexpr double kGravity = 9.81;
// Correlation time of the random slip.
constexpr double kSlipTimeS = 0.05;
constexpr std::uint64_t kPhysicsStream = 1;

Outline outline(const ArenaField& field) {
  const double x = 0.5 * field.length_m, y = 0.5 * field.width_m, g = 0.5 * field.goal_width_m, d = field.goal_depth_m;
  const double c = field.corner_m;
  // Corners counter-clockwise, beginning at the opponent's goal.
  const std::array<Vector2, 16> points{{{x, -g},
                                        {x + d, -g},
                                        {x + d, g},
                                        {x, g},
                                        {x, y - c},
                                        {x - c, y},
                                        {-x + c, y},
                                        {-x, y - c},
                                        {-x, g},
                                        {-x - d, g},
                                        {-x - d, -g},
                                        {-x, -g},
                                        {-x, -y + c},
                                        {-x + c, -y},
                                        {x - c, -y},
                                        {x, -y + c}}};
  Outline walls;
  for (std::size_t i = 0; i < points.size(); ++i) {
    // Skip duplicates, which corner pieces of size zero would give.
    if (length(points[(i + 1) % points.size()] - points[i]) > 1e-9) walls.push_back(points[i]);
  }
  return walls;
}

}  // namespace

World::World(const ArenaParameters& parameters, std::uint64_t seed)
    : parameters_(parameters), random_(seed, kPhysicsStream), walls_(outline(parameters.field)) {
  const PhysicsParameters& physics = parameters_.physics;
  for (const ArenaRobot& entry : parameters_.robot) {
    Robot robot;
    robot.team = entry.team;
    robot.id = entry.id;
    robot.body.inverse_mass = 1.0 / physics.robot_mass_kg;
    // The moment of inertia of a homogeneous square is m a^2 / 6.
    robot.body.inverse_inertia = 6.0 / (physics.robot_mass_kg * parameters_.robot_side_m * parameters_.robot_side_m);
    for (double& gain : robot.gain) gain = 1.0 + physics.wheel_error * random_.normal();
    robot.lag_s.fill(physics.wheel_lag_s);
    if (physics.wheel_lag_error > 0.0) {
      for (double& lag : robot.lag_s) lag *= std::max(0.0, 1.0 + physics.wheel_lag_error * random_.normal());
    }
    if (!robots_.push_back(robot)) break;
    place(robots_.size() - 1, {entry.x_m, entry.y_m, entry.theta_rad});
  }
  ball_.inverse_mass = 1.0 / physics.ball_mass_kg;
  // Spin about the vertical axis is not simulated: it is invisible, and nothing depends on it.
  ball_.inverse_inertia = 0.0;
}

void World::restart(std::uint64_t seed) {
  random_ = Random(seed, kPhysicsStream);
  for (std::size_t i = 0; i < robots_.size(); ++i) {
    const ArenaRobot& entry = parameters_.robot[i];
    place(i, {entry.x_m, entry.y_m, entry.theta_rad});
  }
}

void World::place(std::size_t robot, const Placement& placement) {
  Robot& moved = robots_[robot];
  moved.body.position = {placement.x_m, placement.y_m};
  moved.body.theta = wrap_angle(placement.theta_rad);
  moved.body.velocity = {};
  moved.body.w = 0.0;
  moved.wheel_mps = moved.commanded_mps = {};
}

void World::place_ball(const Placement& placement, Vector2 velocity_mps) {
  ball_.position = {placement.x_m, placement.y_m};
  ball_.velocity = velocity_mps;
}

void World::drive(int id, double left_mps, double right_mps, Side side) {
  const PhysicsParameters& physics = parameters_.physics;
  for (Robot& robot : robots_) {
    if (robot.team != side || robot.id != id) continue;
    robot.commanded_mps = {left_mps, right_mps};
    // Only own robots are wired wrongly, so that somebody can look for the error.
    if (side != Side::kOwn) continue;
    robot.commanded_mps = {physics.left_reversed ? -left_mps : left_mps,
                           physics.right_reversed ? -right_mps : right_mps};
    if (physics.wheels_exchanged) std::swap(robot.commanded_mps[0], robot.commanded_mps[1]);
  }
}

void World::step() {
  for (Robot& robot : robots_) apply_tires(robot);
  roll_ball();
  collide_all();
  for (Robot& robot : robots_) {
    robot.body.position = robot.body.position + kStepS * robot.body.velocity;
    robot.body.theta = wrap_angle(robot.body.theta + kStepS * robot.body.w);
  }
  ball_.position = ball_.position + kStepS * ball_.velocity;
  ++steps_;
}

bool World::touches_ball(std::size_t robot) const {
  // A robot this close to the ball touches it.
  constexpr double kTouchM = 0.002;
  const Body& body = robots_[robot].body;
  const Vector2 at = rotated(ball_.position - body.position, -body.theta);
  const double half = 0.5 * parameters_.robot_side_m;
  const Vector2 outside{std::max(0.0, std::abs(at.x) - half), std::max(0.0, std::abs(at.y) - half)};
  return length(outside) < parameters_.ball_radius_m + kTouchM;
}

bool World::is_driven() const {
  return std::any_of(robots_.begin(), robots_.end(),
                     [](const Robot& robot) { return robot.commanded_mps != std::array<double, 2>{}; });
}

void World::apply_tires(Robot& robot) {
  const PhysicsParameters& physics = parameters_.physics;
  Body& body = robot.body;
  const double slip_kick = physics.wheel_slip * std::sqrt(2.0 * kStepS / kSlipTimeS);
  std::array<double, 2> rim{};
  for (std::size_t i = 0; i < rim.size(); ++i) {
    // Response of a first-order lag to a constant input after one step.
    const double follow = robot.lag_s[i] > 0.0 ? 1.0 - std::exp(-kStepS / robot.lag_s[i]) : 1.0;
    const double commanded = robot.commanded_mps[i], dead = physics.wheel_dead_zone_mps;
    const double driven = commanded - std::clamp(commanded, -dead, dead);
    robot.wheel_mps[i] += follow * (driven - robot.wheel_mps[i]);
    robot.slip[i] += -robot.slip[i] * kStepS / kSlipTimeS + slip_kick * random_.normal();
    rim[i] = robot.wheel_mps[i] * (robot.gain[i] + robot.slip[i]);
  }
  const double ahead_wanted = 0.5 * (rim[0] + rim[1]);
  const double turn_wanted = (rim[1] - rim[0]) / physics.wheel_base_m;
  const Vector2 ahead = rotated({1.0, 0.0}, body.theta), left = perpendicular(ahead);
  // Limit of the velocity change by the tires' friction; without it, the body would follow its wheels immediately.
  const double limit = physics.tire_friction * kGravity * kStepS;  // impulse per mass
  double along = ahead_wanted - dot(body.velocity, ahead);
  double aside = -dot(body.velocity, left);
  const double demand = std::sqrt(along * along + aside * aside);
  if (demand > limit) {
    along *= limit / demand;
    aside *= limit / demand;
  }
  body.velocity = body.velocity + along * ahead + aside * left;
  const double turn_limit = limit * 0.5 * physics.wheel_base_m * physics.robot_mass_kg * body.inverse_inertia;
  body.w += std::clamp(turn_wanted - body.w, -turn_limit, turn_limit);
}

void World::roll_ball() {
  const PhysicsParameters& physics = parameters_.physics;
  const double speed = length(ball_.velocity);
  if (speed <= 0.0) return;
  const double loss = kStepS * (physics.ball_deceleration_mps2 + physics.ball_damping_per_s * speed);
  if (loss >= speed) {
    ball_.velocity = {};
    return;
  }
  ball_.velocity = (1.0 - loss / speed) * ball_.velocity;
  const double kick = physics.floor_roughness_mps_rts * std::sqrt(kStepS) * std::min(1.0, speed);
  ball_.velocity = ball_.velocity + kick * Vector2{random_.normal(), random_.normal()};
}

void World::collide_all() {
  const PhysicsParameters& physics = parameters_.physics;
  const Surface hard{physics.robot_restitution, physics.contact_friction};
  const Surface bouncy{physics.ball_restitution, physics.contact_friction};
  const Circle ball{&ball_, parameters_.ball_radius_m};
  contacts_.clear();
  touching_ = {};
  for (std::size_t i = 0; i < robots_.size(); ++i) {
    const Square a = square(robots_[i]);
    for (std::size_t k = 0; k < i; ++k) {
      const std::size_t before = contacts_.size();
      collide(a, square(robots_[k]), hard, contacts_);
      if (contacts_.size() == before) continue;
      touching_[i] |= 1U << k;
      touching_[k] |= 1U << i;
    }
    collide(a, walls_, hard, contacts_);
    collide(ball, a, bouncy, contacts_);
  }
  collide(ball, walls_, bouncy, contacts_);
  resolve(contacts_);
}

Snapshot World::snapshot() const {
  Snapshot all;
  for (const Robot& robot : robots_) {
    all.robots.push_back({robot.body.position.x, robot.body.position.y, robot.body.theta});
  }
  all.ball = {ball_.position.x, ball_.position.y, 0.0};
  return all;
}

double World::energy() const {
  const auto of = [](const Body& body) {
    const double turning = body.inverse_inertia > 0.0 ? body.w * body.w / body.inverse_inertia : 0.0;
    return 0.5 * (dot(body.velocity, body.velocity) / body.inverse_mass + turning);
  };
  double sum = of(ball_);
  for (const Robot& robot : robots_) sum += of(robot.body);
  return sum;
}

std::uint64_t World::hash() const {
  Fnv1a fnv;
  fnv.add(steps_);
  const auto add_body = [&](const Body& body) {
    fnv.add(body.position);
    fnv.add(body.velocity);
    fnv.add(body.theta);
    fnv.add(body.w);
  };
  for (const Robot& robot : robots_) {
    add_body(robot.body);
    for (std::size_t i = 0; i < 2; ++i) {
      fnv.add(robot.commanded_mps[i]);
      fnv.add(robot.wheel_mps[i]);
      fnv.add(robot.slip[i]);
      fnv.add(robot.gain[i]);
    }
  }
  add_body(ball_);
  Random ahead = random_;
  fnv.add(ahead.bits());
  return fnv.value();
}

}  // namespace touchline::hal::mock
