// Motion of single robots and the ball compared with the models in the parameters.
#include <gtest/gtest.h>

#include "tests/mock/noise_free_arena.h"

namespace touchline::hal::mock {
namespace {

Placement robot_of(const World& world, std::size_t index = 0) { return world.snapshot().robots[index]; }

double speed_of(World& world) {
  const Vector2 before = position(robot_of(world));
  world.step();
  return length(position(robot_of(world)) - before) / World::kStepS;
}

double ball_speed_of(World& world) {
  const Vector2 before = position(world.snapshot().ball);
  world.step();
  return length(position(world.snapshot().ball) - before) / World::kStepS;
}

TEST(Wheels, FollowCommandsWithTheTimeConstant) {
  ArenaParameters parameters = noise_free_arena();
  for (const double lag_s : {0.03, 0.08, 0.2}) {
    parameters.physics.wheel_lag_s = lag_s;
    World world(parameters, 1);
    world.drive(0, 0.2, 0.2);
    run(world, lag_s - World::kStepS);
    // After one time constant the response is 1 - 1/e.
    EXPECT_NEAR(speed_of(world), 0.2 * (1.0 - std::exp(-1.0)), 0.2 * 0.005) << lag_s;
    run(world, 10.0 * lag_s);
    EXPECT_NEAR(speed_of(world), 0.2, 1e-4);
  }
  parameters.physics.wheel_lag_s = 0.0;
  World world(parameters, 1);
  world.drive(0, 0.007, 0.007);  // below the friction limit of one step
  EXPECT_NEAR(speed_of(world), 0.007, 1e-9);
}

TEST(Wheels, TurnRateIsDifferenceOverWheelBase) {
  const ArenaParameters parameters = noise_free_arena();
  World world(parameters, 1);
  world.drive(0, -0.07, 0.07);
  run(world, 1.0);
  const double before = robot_of(world).theta_rad;
  world.step();
  const double rate = std::remainder(robot_of(world).theta_rad - before, 2.0 * std::numbers::pi) / World::kStepS;
  EXPECT_NEAR(rate, 0.14 / parameters.physics.wheel_base_m, 1e-3);
  EXPECT_NEAR(length(position(robot_of(world)) - Vector2{-0.55, 0.0}), 0.0, 1e-9);
}

TEST(Wheels, AnArcHasTheRadiusOfTheTwist) {
  World world(noise_free_arena(), 1);
  world.place(0, {0.0, -0.3, 0.0});
  world.place_ball({-1.0, 0.8, 0.0});
  const double v = 0.15, w = 0.5, half_base = 0.035;
  world.drive(0, v - w * half_base, v + w * half_base);
  run(world, 1.0);
  // The center of the arc, v / w to the left of the robot, stays in place.
  const auto center = [&] {
    const Placement at = robot_of(world);
    return position(at) + v / w * rotated({0.0, 1.0}, at.theta_rad);
  };
  const Vector2 before = center();
  run(world, 2.0);
  EXPECT_NEAR(length(center() - before), 0.0, 0.002);
}

TEST(Tires, LimitAcceleration) {
  ArenaParameters parameters = noise_free_arena();
  parameters.physics.wheel_lag_s = 0.0;
  for (const double friction : {0.1, 0.5}) {
    parameters.physics.tire_friction = friction;
    World world(parameters, 1);
    world.drive(0, 2.0, 2.0);
    double before = 0.0;
    for (int i = 0; i < 100; ++i) {
      const double now = speed_of(world);
      ASSERT_NEAR((now - before) / World::kStepS, friction * 9.81, 1e-6);
      before = now;
    }
  }
}

TEST(Tires, SidewaysMotionSlidesToRest) {
  ArenaParameters parameters = noise_free_arena();
  parameters.physics.tire_friction = 0.3;
  World world(parameters, 1);
  world.drive(0, 1.0, 1.0);
  run(world, 0.6);
  // With blocked wheels the stopping distance is v^2 / (2 mu g).
  parameters.physics.wheel_lag_s = 0.0;
  World sliding(parameters, 1);
  sliding.place(0, {-0.9, 0.0, 0.0});
  sliding.drive(0, 1.0, 1.0);
  run(sliding, 0.5);
  const double v = speed_of(sliding);
  const Vector2 from = position(robot_of(sliding));
  sliding.drive(0, 0.0, 0.0);
  run(sliding, 1.0);
  EXPECT_NEAR(length(position(robot_of(sliding)) - from), v * v / (2.0 * 0.3 * 9.81), 0.002);
}

// Change of a robot's velocities per second, from rest with these wheel speeds.
struct Acceleration {
  double along_mps2 = 0.0, turn_radps2 = 0.0;
};
Acceleration acceleration_of(const ArenaParameters& parameters, double left_mps, double right_mps,
                             double from_mps = 0.0) {
  World world(parameters, 1);
  world.place(0, {-0.3, 0.2, 0.5}, from_mps * unit_vector(0.5));
  world.drive(0, left_mps, right_mps);
  const Placement before = robot_of(world);
  world.step();
  const Placement after = robot_of(world);
  const double along =
      dot(position(after) - position(before), unit_vector(before.theta_rad)) / World::kStepS - from_mps;
  return {along / World::kStepS, (after.theta_rad - before.theta_rad) / World::kStepS / World::kStepS};
}

TEST(Tires, SlideEachForItself) {
  ArenaParameters parameters = noise_free_arena();
  PhysicsParameters& physics = parameters.physics;
  physics.wheel_lag_s = 0.0;
  physics.tire_friction = 0.4;
  physics.inertia_ratio = 1.5;
  // The right tire slides. The left one, whose wheel stands, does not, and holds its point of the floor.
  const double half_base = 0.5 * physics.wheel_base_m, side = parameters.robot_side_m, force = 0.2 * 9.81;
  const double turning = half_base * half_base / (1.5 * side * side / 6.0);
  const double holding = -(1.0 - turning) / (1.0 + turning) * force;
  const Acceleration one = acceleration_of(parameters, 0.0, 1.0);
  EXPECT_NEAR(one.along_mps2, force + holding, 1e-6);
  EXPECT_NEAR(one.turn_radps2, (force - holding) * turning / half_base, 1e-6);
  EXPECT_NEAR(one.along_mps2, half_base * one.turn_radps2, 1e-6) << "the left wheel must not move";
  // Both slide in the same direction, although the commands differ: the robot does not turn.
  const Acceleration both = acceleration_of(parameters, 0.5, 1.0);
  EXPECT_NEAR(both.along_mps2, 2.0 * force, 1e-6);
  EXPECT_NEAR(both.turn_radps2, 0.0, 1e-6);
}

TEST(Tires, TransmitAtMostTheForceOfTheMotors) {
  ArenaParameters parameters = noise_free_arena();
  parameters.physics.wheel_lag_s = 0.0;
  parameters.physics.wheel_force_n = 0.5;
  EXPECT_NEAR(acceleration_of(parameters, 1.0, 1.0).along_mps2, 1.0 / parameters.physics.robot_mass_kg, 1e-6);
}

TEST(Wheels, DoNotExceedTheirLargestSpeed) {
  ArenaParameters parameters = noise_free_arena();
  parameters.physics.wheel_speed_mps = 0.4;
  World world(parameters, 1);
  world.drive(0, -2.0, -2.0);
  run(world, 0.8);
  EXPECT_NEAR(speed_of(world), 0.4, 1e-4);
}

TEST(Skids, OpposeMotionButNotTurns) {
  ArenaParameters parameters = noise_free_arena();
  parameters.physics.wheel_lag_s = 0.0;
  parameters.physics.tire_friction = 0.4;
  const double turn = acceleration_of(parameters, -1.0, 1.0).turn_radps2;
  parameters.physics.skid_friction = 0.3;
  EXPECT_NEAR(acceleration_of(parameters, 1.0, 1.0, 0.3).along_mps2, 0.1 * 9.81, 1e-6);
  EXPECT_NEAR(acceleration_of(parameters, 0.0, 0.0, 0.3).along_mps2, -0.7 * 9.81, 1e-6);
  EXPECT_NEAR(acceleration_of(parameters, -1.0, 1.0).turn_radps2, turn, 1e-6);
  EXPECT_NEAR(acceleration_of(parameters, 0.3, 0.3, 0.3).along_mps2, 0.0, 1e-6);
}

TEST(Wheels, ErrorAndSlipMatchTheParameters) {
  ArenaParameters parameters = noise_free_arena();
  parameters.physics.wheel_error = 0.05;
  parameters.field.length_m = parameters.field.width_m = 20.0;
  double squares = 0.0;
  constexpr int kRobots = 300;
  for (int seed = 0; seed < kRobots; ++seed) {
    World world(parameters, static_cast<std::uint64_t>(seed));
    world.drive(0, 0.3, 0.3);
    run(world, 0.8);
    // The mean of two wheels with independent errors.
    const double gain = speed_of(world) / 0.3;
    squares += (gain - 1.0) * (gain - 1.0);
  }
  EXPECT_NEAR(std::sqrt(squares / kRobots), 0.05 / std::sqrt(2.0), 0.05 / std::sqrt(2.0) * 0.2);

  parameters.physics.wheel_error = 0.0;
  parameters.physics.wheel_slip = 0.1;
  parameters.physics.tire_friction = 3.0;
  World world(parameters, 1);
  world.drive(0, 0.3, 0.3);
  run(world, 0.8);
  squares = 0.0;
  constexpr int kSteps = 20000;
  for (int i = 0; i < kSteps; ++i) {
    const double slip = speed_of(world) / 0.3 - 1.0;
    squares += slip * slip;
  }
  EXPECT_NEAR(std::sqrt(squares / kSteps), 0.1 / std::sqrt(2.0), 0.1 / std::sqrt(2.0) * 0.15);
}

TEST(Ball, DeceleratesAsModeled) {
  ArenaParameters parameters = noise_free_arena();
  parameters.field.length_m = 20.0;
  const double a = parameters.physics.ball_deceleration_mps2, k = parameters.physics.ball_damping_per_s;
  World world(parameters, 1);
  world.place_ball({-5.0, 0.5, 0.0}, {2.0, 0.0});
  for (int i = 1; i <= 5; ++i) {
    run(world, 0.5 - World::kStepS);
    // v' = -a - k v
    const double expected = (2.0 + a / k) * std::exp(-k * 0.5 * i) - a / k;
    EXPECT_NEAR(ball_speed_of(world), expected, 0.002) << i;
  }
  run(world, 6.0);
  EXPECT_EQ(ball_speed_of(world), 0.0);
}

TEST(Ball, BouncesOffTheWallWithItsRestitution) {
  ArenaParameters parameters = noise_free_arena();
  parameters.physics.ball_deceleration_mps2 = parameters.physics.ball_damping_per_s = 0.0;
  World world(parameters, 1);
  world.place_ball({0.5, 0.5, 0.0}, {0.0, 1.0});
  run(world, 0.6);
  EXPECT_NEAR(ball_speed_of(world), parameters.physics.ball_restitution, 1e-3);
  const double high = world.snapshot().ball.y_m;
  world.step();
  EXPECT_LT(world.snapshot().ball.y_m, high);
}

TEST(Ball, BouncesOffARobotWithTheRestitutionOfBoth) {
  ArenaParameters parameters = noise_free_arena();
  parameters.physics.ball_deceleration_mps2 = parameters.physics.ball_damping_per_s = 0.0;
  parameters.physics.robot_mass_kg = 20.0;
  parameters.physics.ball_mass_kg = 0.005;
  for (const double restitution : {0.0, 0.4}) {
    parameters.physics.ball_robot_restitution = restitution;
    World world(parameters, 1);
    world.place_ball({-0.2, 0.0, 0.0}, {-1.0, 0.0});
    run(world, 0.5);
    EXPECT_NEAR(ball_speed_of(world), restitution, 2e-3);
  }
}

TEST(Ball, FloorRoughnessMatchesTheParameter) {
  ArenaParameters parameters = noise_free_arena();
  parameters.physics.ball_deceleration_mps2 = parameters.physics.ball_damping_per_s = 0.0;
  parameters.physics.floor_roughness_mps_rts = 0.02;
  parameters.field.length_m = parameters.field.width_m = 20.0;
  double squares = 0.0;
  constexpr int kBalls = 400;
  for (int seed = 0; seed < kBalls; ++seed) {
    World world(parameters, static_cast<std::uint64_t>(seed));
    world.place_ball({0.0, 3.0, 0.0}, {2.0, 0.0});
    run(world, 0.25);
    const Vector2 before = position(world.snapshot().ball);
    world.step();
    const double sideways = (position(world.snapshot().ball).y - before.y) / World::kStepS;
    squares += sideways * sideways;
  }
  // A random walk: the standard deviation grows with the square root of time.
  EXPECT_NEAR(std::sqrt(squares / kBalls), 0.02 * std::sqrt(0.25), 0.01 * 0.15);
}

TEST(World, PlacedRobotStandsStillUntilDriven) {
  World world(noise_free_arena(), 1);
  world.drive(0, 0.5, 0.5);
  run(world, 0.3);
  world.place(0, {0.3, 0.2, 1.0});
  run(world, 0.5);
  EXPECT_NEAR(robot_of(world).x_m, 0.3, 1e-12);
  EXPECT_NEAR(robot_of(world).y_m, 0.2, 1e-12);
  EXPECT_NEAR(robot_of(world).theta_rad, 1.0, 1e-12);
}

}  // namespace
}  // namespace touchline::hal::mock
