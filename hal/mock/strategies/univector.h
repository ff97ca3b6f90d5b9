#pragma once

#include "hal/mock/strategies/team_strategy.h"
#include "hal/mock/strategies/univector_field.h"

namespace touchline::hal::mock {

/// Gains of the univector control law.
struct UnivectorGains {
  double max_wheel_mps = 0.8;  // limit of the wheels' speed in the law
  double turn_gain = 4.0;      // k in rad/s per square root of a radian of heading error
  double grip = 0.4;           // coefficient of friction that a curve may use
};
/// A real VSSS robot: 0.8 m/s, with UnBrain's gain for slow robots (4; Neon FC states 3.5 for 0.5 m/s).
inline constexpr UnivectorGains kUnivector{};
/// UnBrain (unball/UnBrain 961c726, src/control/UFC.py): k 8, mu 0.4, 2.0 m/s.
inline constexpr UnivectorGains kUnivectorFast{2.0, 8.0, 0.4};

/// The univector-field team that several VSSS teams publish: an attacker that follows spirals to the place behind the
/// ball and then drives straight through it to the goal, a goalkeeper, and assistants at places behind the ball.
class Univector final : public TeamStrategy {
 public:
  explicit Univector(const UnivectorGains& gains) : gains_(gains) {}

 private:
  struct Motion {
    double ahead = 1.0;  // -1: the robot drives backward
    Instant reversed{};
    bool strikes = false;  // the attacker drives straight through the ball
  };
  void begin(const Scene& scene) override { motions_.keep(scene.players); }
  Twist move(const Player& player, const Scene& scene) override;
  Twist keep(const Player& player, const Scene& scene) override;
  void forget() override { motions_.clear(); }

  Twist attack(const Player& player, const Scene& scene);
  Twist assist(const Player& player, const Scene& scene);
  [[nodiscard]] FieldTarget target_at(Vector2 ball) const;
  [[nodiscard]] Vector2 place_of(std::size_t rank, Vector2 ball) const;
  [[nodiscard]] bool is_beside_wall(Vector2 ball) const;
  // The control law. `direction(p)`: the field; `approach_mps`: limit of the speed near the target.
  template <class Direction>
  Twist follow(const Player& player, Instant now, const Direction& direction, double approach_mps);
  using Obstacles = FixedVector<MovingObstacle, kMaxRobots + 1>;
  // Other robots, except those that are nearer to `place` than a robot's size: the robot is meant to go there.
  void list_obstacles(const Player& player, const Scene& scene, Vector2 place, Obstacles& out) const;
  // Lengths of the field are stated for robots of 75 mm.
  [[nodiscard]] double scale() const { return radius_m() / 0.0375; }

  UnivectorGains gains_;
  PlayerMemory<Motion> motions_;
};

}  // namespace touchline::hal::mock
