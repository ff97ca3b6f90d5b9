#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/types.h"
#include "hal/mock/arena_parameters.h"
#include "hal/mock/random.h"
#include "hal/mock/rigid_body.h"

namespace touchline::hal::mock {

/// Where something is; meters and radians, field frame.
struct Placement {
  double x_m = 0.0, y_m = 0.0, theta_rad = 0.0;
};

/// Everything that can be seen at one instant.
struct Snapshot {
  FixedVector<Placement, kMaxRobots> robots;  // in the order of ArenaParameters::robot
  Placement ball;
};

struct GameStatistics {
  std::uint64_t touches = 0;  // times that an own robot came to the ball
  double ball_path_m = 0.0;
  std::uint32_t goals_own = 0, goals_opponent = 0;  // scored by
  std::uint32_t free_balls = 0;
};

/// Robots, ball and walls. Rigid bodies in the plane, steps of a millisecond: wheels with lag, constant error and
/// random slip push through tires that slide beyond their friction; what meets exchanges impulses. Nothing is allocated
/// after construction, and the same seed and commands give the same states to the bit.
class World {
 public:
  static constexpr double kStepS = 0.001;

  World(const ArenaParameters& parameters, std::uint64_t seed);
  World(const World&) = delete;
  World& operator=(const World&) = delete;
  ~World() = default;

  /// Own robot `id` drives these wheel speeds from now on; a robot that is not there is ignored.
  void drive(int id, double left_mps, double right_mps);
  void step();

  [[nodiscard]] Snapshot snapshot() const;
  [[nodiscard]] const GameStatistics& statistics() const { return statistics_; }
  /// FNV-1a over the statistics and all that the future depends on, the random generator's state included.
  [[nodiscard]] std::uint64_t hash() const;
  /// Kinetic energy of robots and ball, J.
  [[nodiscard]] double energy() const;

  /// For scenes and tests. A robot that is placed stands until it is driven again.
  void place(std::size_t robot, const Placement& placement);
  void place_ball(const Placement& placement, Vec2 velocity_mps = {});

 private:
  struct Robot {
    Body body;
    Side team = Side::kOwn;
    int id = 0;
    std::array<double, 2> wanted_mps{}, wheel_mps{}, gain{1.0, 1.0}, slip{};
    Vec2 target;  // opponents: where it wanders to
    double decide_in_s = 0.0;
    bool at_ball = false;
  };

  void play_opponent(Robot& robot, bool is_nearest);
  void play_opponents();
  void apply_tires(Robot& robot);
  void roll_ball();
  void collide_all();
  void count_touches();
  void referee();
  void kick_off();
  [[nodiscard]] Square square(Robot& robot) const { return {&robot.body, 0.5 * parameters_.robot_side_m}; }

  const ArenaParameters parameters_;
  Random random_;
  FixedVector<Robot, kMaxRobots> robots_;
  Body ball_;
  Outline walls_;
  Contacts contacts_;
  GameStatistics statistics_;
  double still_s_ = 0.0;
  Vec2 still_at_;
  std::uint64_t steps_ = 0;
};

}  // namespace touchline::hal::mock
