#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/types.h"
#include "hal/mock/arena_parameters.h"
#include "hal/mock/random.h"
#include "hal/mock/rigid_body.h"

namespace touchline::hal::mock {

/// Pose of an object in the field frame, in meters and radians.
struct Placement {
  double x_m = 0.0, y_m = 0.0, theta_rad = 0.0;
};

/// Returns the pose that a steady motion from `begin` to `end` has after this share of its time.
Placement between(const Placement& begin, const Placement& end, double share);

/// Poses of all visible objects at one instant.
struct Snapshot {
  FixedVector<Placement, kMaxRobots> robots;  // in the order of ArenaParameters::robot
  Placement ball;
};

/// Simulates robots, ball and walls as rigid bodies in the plane, in steps of one millisecond. Wheels have a dead zone,
/// a lag, a constant gain error and random slip; each tire slides when its friction or the force of its motor is
/// exceeded; bodies in contact exchange impulses. Nothing is allocated after construction. The same seed and commands
/// give bit-identical states.
class World {
 public:
  static constexpr double kStepS = 0.001;

  World(const ArenaParameters& parameters, std::uint64_t seed);
  World(const World&) = delete;
  World& operator=(const World&) = delete;
  ~World() = default;

  /// Sets the commanded wheel speeds of robot `id` of a side. An unknown id is ignored.
  void drive(int id, double left_mps, double right_mps, Side side = Side::kOwn);
  /// Advances the world by kStepS.
  void step();

  [[nodiscard]] Snapshot snapshot() const;
  /// The robots of this world, in the order of ArenaParameters::robot.
  [[nodiscard]] std::size_t robots() const { return robots_.size(); }
  [[nodiscard]] Side side(std::size_t robot) const { return robots_[robot].team; }
  [[nodiscard]] int id(std::size_t robot) const { return robots_[robot].id; }
  [[nodiscard]] Vector2 ball() const { return ball_.position; }
  [[nodiscard]] Vector2 ball_velocity() const { return ball_.velocity; }
  /// Returns whether the robot touches the ball, or is so near that nobody sees a gap.
  [[nodiscard]] bool touches_ball(std::size_t robot) const;
  /// Returns the robots that this one touches, as bits.
  [[nodiscard]] std::uint32_t touching(std::size_t robot) const { return touching_[robot]; }
  /// Returns whether somebody's command moves a robot.
  [[nodiscard]] bool is_driven() const;
  /// FNV-1a hash of the complete state, including the random generator's.
  [[nodiscard]] std::uint64_t hash() const;
  /// Kinetic energy of robots and ball in J.
  [[nodiscard]] double energy() const;

  /// What the simulated motors of a robot are, for measurements that are compared with the truth; for left and right.
  struct Motors {
    std::array<double, 2> gain{1.0, 1.0}, lag_s{};
  };
  /// Returns the speeds of the wheels' rims of own robot `id`, as its encoders measure them; 0 for an unknown id.
  [[nodiscard]] WheelSpeeds wheel_speeds(int id, Side side = Side::kOwn) const;
  /// Robots are numbered as in ArenaParameters::robot.
  [[nodiscard]] Motors motors(std::size_t robot) const { return {robots_[robot].gain, robots_[robot].lag_s}; }

  /// Puts the robots where they were at the begin, and draws other random numbers from now on. The robots stay the
  /// same.
  void restart(std::uint64_t seed);
  /// For scenes and tests. A placed robot rolls with this velocity, and stops unless drive() is called for it.
  void place(std::size_t robot, const Placement& placement, Vector2 velocity_mps = {}, double w_radps = 0.0);
  void place_ball(const Placement& placement, Vector2 velocity_mps = {});

 private:
  struct Robot {
    Body body;
    Vector2 ahead;  // unit vector of the heading
    Side team = Side::kOwn;
    int id = 0;
    std::array<double, 2> commanded_mps{}, wheel_mps{}, gain{1.0, 1.0}, lag_s{}, slip{};
    std::array<double, 2> follow{};  // response of the wheels' lag to a constant input after one step
  };

  void turn_wheels(Robot& robot);
  void apply_tires(Robot& robot);
  /// Speed with which a wheel's rim drives the floor.
  [[nodiscard]] static double rim_mps(const Robot& robot, std::size_t wheel) {
    return robot.wheel_mps[wheel] * (robot.gain[wheel] + robot.slip[wheel]);
  }
  void roll_ball();
  void collide_all();
  [[nodiscard]] Square square(Robot& robot) const { return {&robot.body, 0.5 * parameters_.robot_side_m, robot.ahead}; }
  [[nodiscard]] bool is_far_from_walls(Vector2 position, double reach_m) const;

  const ArenaParameters parameters_;
  Random random_;
  FixedVector<Robot, kMaxRobots> robots_;
  Body ball_;
  Outline walls_;
  Contacts contacts_;
  std::array<std::uint32_t, kMaxRobots> touching_{};  // by robot: bits of the robots that it touches
  std::uint64_t steps_ = 0;
};

}  // namespace touchline::hal::mock
