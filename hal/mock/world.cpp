#include "hal/mock/world.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/geometry/angle.h"
#include "hal/fnv1a.h"

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

Placement between(const Placement& begin, const Placement& end, double share) {
  const double turn = wrap_angle(end.theta_rad - begin.theta_rad);
  return {begin.x_m + share * (end.x_m - begin.x_m), begin.y_m + share * (end.y_m - begin.y_m),
          wrap_angle(begin.theta_rad + share * turn)};
}

World::World(const ArenaParameters& parameters, std::uint64_t seed)
    : parameters_(parameters), random_(seed, kPhysicsStream), walls_(outline(parameters.field)) {
  const PhysicsParameters& physics = parameters_.physics;
  for (const ArenaRobot& entry : parameters_.robot) {
    Robot robot;
    robot.team = entry.team;
    robot.id = entry.id;
    robot.body.inverse_mass = 1.0 / physics.robot_mass_kg;
    // The moment of inertia of a homogeneous square is m a^2 / 6.
    robot.body.inverse_inertia =
        6.0 / (physics.robot_mass_kg * parameters_.robot_side_m * parameters_.robot_side_m) / physics.inertia_ratio;
    for (double& gain : robot.gain) gain = 1.0 + physics.wheel_error * random_.normal();
    robot.lag_s.fill(physics.wheel_lag_s);
    if (physics.wheel_lag_error > 0.0) {
      for (double& lag : robot.lag_s) lag *= std::max(0.0, 1.0 + physics.wheel_lag_error * random_.normal());
    }
    for (std::size_t i = 0; i < 2; ++i) {
      robot.follow[i] = robot.lag_s[i] > 0.0 ? 1.0 - std::exp(-kStepS / robot.lag_s[i]) : 1.0;
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
    robots_[i].slip = {};
  }
}

void World::place(std::size_t robot, const Placement& placement, Vector2 velocity_mps, double w_radps) {
  Robot& moved = robots_[robot];
  moved.body.position = {placement.x_m, placement.y_m};
  moved.body.theta = wrap_angle(placement.theta_rad);
  moved.ahead = unit_vector(moved.body.theta);
  moved.body.velocity = velocity_mps;
  moved.body.w = w_radps;
  const double along = dot(velocity_mps, moved.ahead), turn = 0.5 * parameters_.physics.wheel_base_m * w_radps;
  moved.wheel_mps = {along - turn, along + turn};
  moved.commanded_mps = {};
}

void World::place_ball(const Placement& placement, Vector2 velocity_mps) {
  ball_.position = {placement.x_m, placement.y_m};
  ball_.velocity = velocity_mps;
}

WheelSpeeds World::wheel_speeds(int id, Side side) const {
  for (const Robot& robot : robots_) {
    if (robot.team != side || robot.id != id) continue;
    return {static_cast<float>(robot.wheel_mps[0]), static_cast<float>(robot.wheel_mps[1])};
  }
  return {};
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
  for (Robot& robot : robots_) {
    turn_wheels(robot);
    apply_tires(robot);
  }
  roll_ball();
  collide_all();
  for (Robot& robot : robots_) {
    robot.body.position = robot.body.position + kStepS * robot.body.velocity;
    robot.body.theta = wrap_angle(robot.body.theta + kStepS * robot.body.w);
    robot.ahead = unit_vector(robot.body.theta);
  }
  ball_.position = ball_.position + kStepS * ball_.velocity;
  ++steps_;
}

bool World::touches_ball(std::size_t robot) const {
  // A robot this close to the ball touches it.
  constexpr double kTouchM = 0.002;
  const Vector2 to_ball = ball_.position - robots_[robot].body.position, ahead = robots_[robot].ahead;
  const Vector2 at{dot(to_ball, ahead), dot(to_ball, perpendicular(ahead))};
  const double half = 0.5 * parameters_.robot_side_m;
  const Vector2 outside{std::max(0.0, std::abs(at.x) - half), std::max(0.0, std::abs(at.y) - half)};
  return length(outside) < parameters_.ball_radius_m + kTouchM;
}

bool World::is_driven() const {
  return std::any_of(robots_.begin(), robots_.end(),
                     [](const Robot& robot) { return robot.commanded_mps != std::array<double, 2>{}; });
}

void World::turn_wheels(Robot& robot) {
  const PhysicsParameters& physics = parameters_.physics;
  for (std::size_t i = 0; i < 2; ++i) {
    const double top = physics.wheel_speed_mps, dead = physics.wheel_dead_zone_mps;
    const double commanded = std::clamp(robot.commanded_mps[i], -top, top);
    const double driven = commanded - std::clamp(commanded, -dead, dead);
    robot.wheel_mps[i] += robot.follow[i] * (driven - robot.wheel_mps[i]);
  }
  if (physics.wheel_slip <= 0.0) return;
  const double slip_kick = physics.wheel_slip * std::sqrt(2.0 * kStepS / kSlipTimeS);
  const std::array<double, 2> kick = random_.normal_pair();
  for (std::size_t i = 0; i < 2; ++i) {
    robot.slip[i] += -robot.slip[i] * (kStepS / kSlipTimeS) + slip_kick * kick[i];
  }
}

void World::apply_tires(Robot& robot) {
  const PhysicsParameters& physics = parameters_.physics;
  Body& body = robot.body;
  // Everything here is per mass of the robot: an impulse per mass is a change of velocity.
  const double weight = kGravity * kStepS;
  if (const double speed = length(body.velocity), drag = physics.skid_friction * weight; drag > 0.0 && speed > 0.0) {
    body.velocity = std::max(0.0, 1.0 - drag / speed) * body.velocity;
  }
  const Vector2 ahead = robot.ahead, left = perpendicular(ahead);
  // An impulse p of the wheel at distance h from the center changes the speed of its own contact with the floor by
  // (1 + h^2 / k^2) p, and the other wheel's by (1 - h^2 / k^2) p; k: radius of gyration.
  const double h = 0.5 * physics.wheel_base_m;
  const double turning = h * h * body.inverse_inertia / body.inverse_mass;
  const double own = 1.0 + turning, other = 1.0 - turning;
  const double along = dot(body.velocity, ahead);
  const std::array<double, 2> missing{rim_mps(robot, 0) - (along - h * body.w),
                                      rim_mps(robot, 1) - (along + h * body.w)};
  const double sum = 0.5 * (missing[0] + missing[1]), difference = 0.5 * (missing[1] - missing[0]) / turning;
  std::array<double, 2> impulse{0.5 * (sum - difference), 0.5 * (sum + difference)};
  const double limit =
      std::min(0.5 * physics.tire_friction * weight, physics.wheel_force_n * body.inverse_mass * kStepS);
  if (std::max(std::abs(impulse[0]), std::abs(impulse[1])) > limit) {
    // One tire slides. The other one grips unless what the first one still contributes is too little.
    const std::size_t sliding = std::abs(impulse[1]) > std::abs(impulse[0]) ? 1 : 0, gripping = 1 - sliding;
    impulse[sliding] = std::clamp(impulse[sliding], -limit, limit);
    impulse[gripping] = std::clamp((missing[gripping] - other * impulse[sliding]) / own, -limit, limit);
    impulse[sliding] = std::clamp((missing[sliding] - other * impulse[gripping]) / own, -limit, limit);
  }
  const double side_limit = physics.tire_side_friction * weight;
  const double aside = std::clamp(-dot(body.velocity, left), -side_limit, side_limit);
  body.velocity = body.velocity + (impulse[0] + impulse[1]) * ahead + aside * left;
  body.w += (impulse[1] - impulse[0]) * turning / h;
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
  if (physics.floor_roughness_mps_rts <= 0.0) return;
  const double size = physics.floor_roughness_mps_rts * std::sqrt(kStepS) * std::min(1.0, speed);
  const std::array<double, 2> kick = random_.normal_pair();
  ball_.velocity = ball_.velocity + size * Vector2{kick[0], kick[1]};
}

// Returns whether no wall is nearer than `reach_m`: sides of the field and the diagonal corner pieces. Bodies in a goal
// are near.
bool World::is_far_from_walls(Vector2 position, double reach_m) const {
  const ArenaField& field = parameters_.field;
  const double x = 0.5 * field.length_m - std::abs(position.x), y = 0.5 * field.width_m - std::abs(position.y);
  return x > reach_m && y > reach_m && x + y > field.corner_m + std::numbers::sqrt2 * reach_m;
}

void World::collide_all() {
  const PhysicsParameters& physics = parameters_.physics;
  const Surface robots{physics.robot_restitution, physics.contact_friction};
  const Surface ball_at_robots{physics.ball_robot_restitution, physics.ball_robot_friction};
  const Surface ball_at_walls{physics.ball_restitution, physics.ball_friction};
  const Circle ball{&ball_, parameters_.ball_radius_m};
  // A corner is sqrt(2) / 2 sides away from the center; rounded up.
  const double robot_reach = 0.7072 * parameters_.robot_side_m;
  contacts_.clear();
  touching_ = {};
  for (std::size_t i = 0; i < robots_.size(); ++i) {
    const Square a = square(robots_[i]);
    for (std::size_t k = 0; k < i; ++k) {
      const std::size_t before = contacts_.size();
      collide(a, square(robots_[k]), robots, contacts_);
      if (contacts_.size() == before) continue;
      touching_[i] |= 1U << k;
      touching_[k] |= 1U << i;
    }
    if (!is_far_from_walls(a.body->position, robot_reach)) collide(a, walls_, robots, contacts_);
    collide(ball, a, ball_at_robots, contacts_);
  }
  if (!is_far_from_walls(ball_.position, ball.radius_m)) collide(ball, walls_, ball_at_walls, contacts_);
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
