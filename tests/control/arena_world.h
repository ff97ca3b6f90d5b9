#pragma once

#include <random>
#include <vector>

#include "core/geometry/vector2.h"
#include "core/marker/matcher.h"
#include "core/types.h"

namespace touchline {

inline constexpr double kFrame = 0.016;  // time between two frames in s

inline Instant at(double time_s) { return Instant{} + from_seconds(time_s); }

/// The arena's physics (hal/mock/world.h) for closed-loop tests of the controller: without noise, errors and delay.
/// Tests may change every member between two calls of advance(). It can be copied.
class ArenaWorld {
 public:
  struct Robot {
    Team team = Team::kOwn;
    RobotId id = kUnknownId;
    Vector2 position;
    double heading = 0.0, w = 0.0;
    Vector2 velocity;
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
  // Counts a goal, and puts the ball into the center.
  void watch_goals();
};

}  // namespace touchline
