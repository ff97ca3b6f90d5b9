#pragma once

#include "hal/mock/strategies/player_memory.h"
#include "hal/mock/strategies/team_strategy.h"
#include "hal/mock/strategies/univector_field.h"

namespace touchline::hal::mock {

/// Gains of the univector control law.
struct UnivectorGains {
  double max_wheel_mps = 0.8;  // limit of the wheels' speed in the law; the drive's limit applies as well
  double turn_gain = 4.0;      // k in rad/s per square root of a radian of heading error
  double grip = 0.4;           // coefficient of friction that a curve may use
};

/// A team whose robots drive by univector fields. Its attacker is that of several VSSS teams: it follows spirals to the
/// place behind the ball, then drives straight through the ball to the goal.
class UnivectorTeam : public TeamStrategy {
 protected:
  explicit UnivectorTeam(const UnivectorGains& gains) : gains_(gains) {}

  void begin(const Scene& scene) override { motions_.keep(scene.players); }
  void forget() override { motions_.clear(); }
  Twist keep(const Player& player, const Scene& scene) override;

  /// What a robot drives around: other robots on its way to the ball, or nothing.
  enum class Avoid { kNothing, kRobots };
  Twist attack(const Player& player, const Scene& scene, Avoid avoid);
  /// Drives to a place around other robots and the ball, and stops there.
  Twist go_to(const Player& player, const Scene& scene, Vector2 place);

 private:
  struct Motion {
    double ahead = 1.0;  // -1: the robot drives backward
    Instant reversed{};
    bool strikes = false;  // the attacker drives straight through the ball
  };
  // The obstacles of one robot: the other robots, and the ball.
  using Obstacles = FixedVector<MovingObstacle, kMaxRobots + 1>;

  // The control law. `direction(p)`: the field; `approach_mps`: limit of the speed near the target.
  template <class Direction>
  Twist follow(const Player& player, Instant now, const Direction& direction, double approach_mps);
  // Drives straight: to the ball when it is far, to the goal when it is near.
  Twist strike(const Player& player, Instant now, Vector2 ball);
  [[nodiscard]] bool begins_strike(const Player& player, double ahead, Vector2 ball) const;
  // Returns whether an opponent is near the robot.
  [[nodiscard]] bool is_contested(Vector2 robot, const Scene& scene) const;
  [[nodiscard]] bool is_in_corner(Vector2 ball) const;
  [[nodiscard]] FieldTarget target_at(Vector2 ball) const;
  [[nodiscard]] bool is_beside_wall(Vector2 ball) const;
  // Lists other robots, except those at `place`, to which the robot is meant to go.
  void list_obstacles(const Player& player, const Scene& scene, Vector2 place, Obstacles& out) const;
  [[nodiscard]] double around(Vector2 p, double direction_rad, const Player& player, const Obstacles& obstacles) const;
  [[nodiscard]] double wheel_limit_mps() const;
  // UnBrain spins at a ball within 85 mm.
  [[nodiscard]] double touching_m() const { return 0.085 * scale(); }
  // UnBrain regards a ball as beside a wall within 0.12 m of it.
  [[nodiscard]] double beside_m() const { return 0.12 * scale(); }

  UnivectorGains gains_;
  PlayerMemory<Motion> motions_;
};

}  // namespace touchline::hal::mock
