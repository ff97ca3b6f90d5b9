#pragma once

#include "core/control/scene.h"

// How the ball is struck: which contact, and what it is worth. All costs are in seconds.
namespace touchline {

/// A planned contact with the ball.
struct Strike {
  SkillGoal goal;  // the robot's place at the contact, and its direction through the ball
  Vector2 ball;    // where the ball will be
  double direction_rad = 0.0;
  double contact_s = 1e9;  // time until the contact
  double cost_s = 1e9;     // estimated time until the ball is in the opponents' goal
};

/// Estimates the time in s until a ball that nobody of ours touches any more is in the opponents' goal: less if it
/// rolls there, more if opponents stop it or if it rolls to the own goal.
double time_to_goal(BallState ball, const Scene& scene);

/// Ball after a robot's flat side that moves with this speed along `normal_rad` has hit it.
BallState struck(BallState ball, double normal_rad, double speed_mps, const BallMotionParameters& parameters);

/// Contacts that the team could make: times, places of the ball and directions, with the time to the goal after each.
/// They do not depend on the robot.
class StrikeOptions {
 public:
  void find(const Scene& scene);
  /// Returns the best contact of a robot. `former`: direction of its last plan, which is kept unless another one is
  /// better by the hysteresis; null: none.
  [[nodiscard]] Strike best_for(const Player& robot, const double* former, const Scene& scene);

 private:
  static constexpr std::size_t kTimes = 9, kAims = 5, kRound = 12;
  struct Option {
    BallState ball;
    double from_s = 0.0;  // time at which the ball is there
    double direction_rad = 0.0;
    Vector2 place;         // of the robot
    double after_s = 0.0;  // time to the goal after the contact, or a lower bound
    bool is_bound = true;  // after_s is not yet computed: most contacts are too late or too far from the goal
  };
  void add(BallState ball, double from_s, double direction_rad, const Scene& scene);
  // Replaces the lower bound by the time.
  void complete(Option& option, const Scene& scene);

  FixedVector<Option, kTimes*(kAims + kRound)> options_;
};

}  // namespace touchline
