#pragma once

#include <array>
#include <cstdint>

#include "core/types.h"

namespace touchline {

/// Compares the motion of the own robots, as seen, with the commands that act on them. Both velocities pass one
/// low-pass filter, so that noise of the sightings averages out and the lag of the wheels matters little. Their powers,
/// averaged over about half a second, tell how a robot moves.
///
/// A single robot that does not follow its commands is blocked, pushed, carried or broken. If nearly all robots do not
/// follow theirs, the picture and the commands do not belong together: the picture is old, the robots obey another
/// sender, or motors are exchanged.
class MotionCheck {
 public:
  /// `wheel_base_m`, `wheel_lag_s`: values of the own robots.
  void configure(double wheel_base_m, double wheel_lag_s);
  void restart();

  /// Numbers of the robots that were seen and have been commanded to move for some time, and how they move.
  struct Counts {
    int commanded = 0, standing = 0, contradicting = 0;
  };
  struct Result {
    Counts counts;
    bool contradicts = false;  // the robots move, but not as commanded
    bool stands = false;       // all robots stand
  };
  /// `twist_of` returns the commanded twist that acts on the robot with this id, RobotId -> Twist.
  template <class TwistOf>
  Result check(const Sightings& sightings, Instant now, TwistOf twist_of) {
    for (const RobotSighting& robot : sightings.robots) {
      if (is_certain(robot)) follow(robot, twist_of(robot.id), now);
    }
    return judge(now);
  }

 private:
  // Linear velocity, and angular velocity times half the wheel base, in m/s. Each is judged on its own, because a robot
  // that mostly drives ahead shows little of how it turns.
  using Velocity = std::array<float, 2>;
  struct Power {
    float seen = 0.0f, commanded = 0.0f, error = 0.0f;
  };
  struct Robot {
    RobotId id = kUnknownId;
    Instant seen_at{};
    Pose pose;
    Velocity wheels{};  // commanded velocity after the lag of the wheels
    Velocity seen{}, commanded{};
    std::array<Power, 2> power{};
  };

  static bool is_certain(const RobotSighting& robot);
  void follow(const RobotSighting& robot, Twist commanded, Instant now);
  static bool contradicts(const Power& power);
  Result judge(Instant now);

  float lever_m_ = 0.0f, wheel_lag_s_ = 0.0f;
  FixedVector<Robot, kMaxRobotsPerTeam> robots_;
  bool contradicts_ = false, stands_ = false;
  Instant contradicts_since_{}, stands_since_{};
};

}  // namespace touchline
