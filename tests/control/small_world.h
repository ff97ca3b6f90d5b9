#pragma once

#include <random>
#include <vector>

#include "core/geometry/vector2.h"
#include "core/marker/matcher.h"
#include "core/types.h"

namespace touchline {

inline constexpr double kFrame = 0.016;  // time between two frames in s

inline Instant at(double time_s) { return Instant{} + from_seconds(time_s); }

/// A minimal simulation for closed-loop tests of the controller. Robots follow their commands with a lag, do not pass
/// through each other or the walls, and push the ball with their square bodies. Forces are not modeled.
class SmallWorld {
 public:
  struct Robot {
    Team team = Team::kOwn;
    RobotId id = kUnknownId;
    Vector2 position;
    double heading = 0.0, v = 0.0, w = 0.0;
    Twist command;
    bool jammed = false;  // the robot does not move, whatever the command
  };

  FieldParameters field;
  std::vector<Robot> robots;
  Vector2 ball, ball_velocity;
  int goals = 0, own_goals = 0;
  double time_s = 0.0;
  double robot_contact_s = 0.0;  // time in which two own robots pushed each other, summed over pairs

  /// Places own robots 1, 3 and 5 and the ball, so that the controller has a task for each.
  void place_three_robots();
  void obey(const Commands& commands);
  void advance(double dt_s);
  /// Returns the tracks of an ideal tracker; `noise` scatters positions by noise_m and headings by 10 noise_m rad.
  Tracks tracks(std::mt19937* noise = nullptr, double noise_m = 0.0) const;

 private:
  void move(Robot& robot, double dt_s) const;
  void separate(double dt_s);
  void push_ball(const Robot& robot);
  void keep_ball_inside();
};

}  // namespace touchline
