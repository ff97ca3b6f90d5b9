#pragma once

#include "core/parameter.h"

namespace touchline {

/// What a robot can do. Defaults: a MiroSot / VSS robot of 75 mm with two motors.
struct DriveParameters {
  double wheel_base_m = 0.07;
  double max_speed_mps = 1.2;
  double max_turn_radps = 14.0;
  double max_wheel_speed_mps = 1.4;
  double max_wheel_acceleration_mps2 = 4.0;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.number("wheel_base_m", self.wheel_base_m, Range{0.01, 1.0}, "m", "Distance of the wheels");
    visit.number("max_speed_mps", self.max_speed_mps, Range{0.01, 10.0}, "m/s", "Linear velocity commanded at most");
    visit.number("max_turn_radps", self.max_turn_radps, Range{0.1, 100.0}, "rad/s",
                 "Angular velocity commanded at most");
    visit.number("max_wheel_speed_mps", self.max_wheel_speed_mps, Range{0.01, 10.0}, "m/s",
                 "Rim speed of a wheel at most; both are scaled, so that the robot stays on its curve");
    visit.number("max_wheel_acceleration_mps2", self.max_wheel_acceleration_mps2, Range{0.1, 100.0}, "m/s^2",
                 "Change of a wheel's commanded speed; beyond the tires slip");
  }
};

/// Gains of the control laws.
struct MotionParameters {
  double distance_per_s = 3.5;
  double bearing_per_s = 8.0;
  double approach_weight = 1.5;
  double heading_per_s = 8.0;
  double arrived_m = 0.012;
  double tracking_damping = 0.8;
  double tracking_per_m2 = 60.0;
  double tracking_floor_per_s = 4.0;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.number("distance_per_s", self.distance_per_s, Range{0.1, 20.0}, "1/s",
                 "Speed for each meter that is left to go (gamma of Aicardi)");
    visit.number("bearing_per_s", self.bearing_per_s, Range{0.1, 50.0}, "1/s",
                 "Turn rate for each radian off the target's bearing (k of Aicardi)");
    visit.number("approach_weight", self.approach_weight, Range{0.1, 10.0}, "",
                 "Weight of the direction from which a pose is approached (h of Aicardi)");
    visit.number("heading_per_s", self.heading_per_s, Range{0.1, 50.0}, "1/s",
                 "Turn rate for each radian of heading error of a robot that stands in its place");
    visit.number("arrived_m", self.arrived_m, Range{0.001, 0.2}, "m", "Nearer than this, a robot only turns");
    visit.number("tracking_damping", self.tracking_damping, Range{0.1, 5.0}, "", "Damping of trajectory tracking");
    visit.number("tracking_per_m2", self.tracking_per_m2, Range{0.1, 1000.0}, "1/m^2",
                 "Stiffness of trajectory tracking: square of its frequency, in radians for each meter of way");
    visit.number("tracking_floor_per_s", self.tracking_floor_per_s, Range{0.0, 20.0}, "1/s",
                 "Frequency of trajectory tracking when the reference stands");
  }
};

/// Who does what on the field.
struct PlayParameters {
  bool enabled = true;
  int goalkeeper_id = -1;
  double robot_radius_m = 0.0375;
  double clearance_m = 0.11;
  double behind_ball_m = 0.11;
  double corridor_m = 0.02;
  double corridor_slope = 0.35;
  double push_speed_mps = 0.8;
  double wall_m = 0.07;
  double keeper_line_m = 0.07;
  double attacker_hysteresis_m = 0.15;
  double slot_hysteresis_m = 0.1;
  double max_coast_s = 0.15;
  double stuck_after_s = 0.6;
  double escape_for_s = 0.35;
  double escape_speed_mps = 0.4;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.flag("enabled", self.enabled, "Play the default game; false: robots stand");
    visit.number("goalkeeper_id", self.goalkeeper_id, Range{-1, 127}, "",
                 "Id of the goalkeeper; -1: nearest to the goal");
    visit.number("robot_radius_m", self.robot_radius_m, Range{0.005, 0.5}, "m", "Half a robot's side");
    visit.number("clearance_m", self.clearance_m, Range{0.01, 1.0}, "m",
                 "Distance at which robots pass each other, center to center");
    visit.number("behind_ball_m", self.behind_ball_m, Range{0.02, 1.0}, "m", "Where an attack on the ball begins");
    visit.number("corridor_m", self.corridor_m, Range{0.001, 0.2}, "m",
                 "Half width, at the ball, of the corridor in which the attacker drives straight at it");
    visit.number("corridor_slope", self.corridor_slope, Range{0.0, 2.0}, "",
                 "How much the corridor's half width grows for each meter behind the ball");
    visit.number("push_speed_mps", self.push_speed_mps, Range{0.05, 10.0}, "m/s", "Speed at which the ball is pushed");
    visit.number("wall_m", self.wall_m, Range{0.0, 0.5}, "m",
                 "Distance of the ball from a wall up to which no robot fits between them");
    visit.number("keeper_line_m", self.keeper_line_m, Range{0.0, 1.0}, "m", "Goalkeeper's distance from the goal line");
    visit.number("attacker_hysteresis_m", self.attacker_hysteresis_m, Range{0.0, 2.0}, "m",
                 "How much nearer to the ball another robot must be to become attacker");
    visit.number("slot_hysteresis_m", self.slot_hysteresis_m, Range{0.0, 2.0}, "m",
                 "How much nearer to a supporter's place another robot must be to take it");
    visit.number("max_coast_s", self.max_coast_s, Range{0.0, 5.0}, "s",
                 "A robot that was not seen for longer is told to stand");
    visit.number("stuck_after_s", self.stuck_after_s, Range{0.1, 10.0}, "s",
                 "Time without motion, although commanded, after which a robot frees itself");
    visit.number("escape_for_s", self.escape_for_s, Range{0.05, 5.0}, "s", "How long it backs off then");
    visit.number("escape_speed_mps", self.escape_speed_mps, Range{0.05, 10.0}, "m/s", "How fast it backs off");
  }
};

struct ControlParameters {
  DriveParameters drive;
  MotionParameters motion;
  PlayParameters play;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.section("drive", self.drive, "Wheels and limits");
    visit.section("motion", self.motion, "Gains of the control laws");
    visit.section("play", self.play, "Who does what");
  }
};

}  // namespace touchline
