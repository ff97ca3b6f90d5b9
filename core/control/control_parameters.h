#pragma once

#include <array>
#include <cstdint>

#include "core/parameter.h"

namespace touchline {

/// Limits of a robot's drive. Defaults: a MiroSot or VSS robot of 75 mm with two motors.
struct DriveParameters {
  double wheel_base_m = 0.07;
  double max_speed_mps = 1.2;
  double max_turn_radps = 14.0;
  double max_wheel_speed_mps = 1.4;
  double max_wheel_acceleration_mps2 = 4.0;
  // What the tracker believes of the drive; the pipeline copies both from tracking.robot. Lag of the wheels behind
  // their commands, and acceleration at which the tires begin to slide (0: never).
  double wheel_lag_s = 0.08;
  double tire_grip_mps2 = 7.8;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.number(self.wheel_base_m,
                 {.name = "wheel_base_m", .range = {0.01, 1.0}, .unit = "m", .help = "Distance between the wheels"});
    visit.number(
        self.max_speed_mps,
        {.name = "max_speed_mps", .range = {0.01, 10.0}, .unit = "m/s", .help = "Maximum commanded linear velocity"});
    visit.number(self.max_turn_radps, {.name = "max_turn_radps",
                                       .range = {0.1, 100.0},
                                       .unit = "rad/s",
                                       .help = "Maximum commanded angular velocity"});
    visit.number(self.max_wheel_speed_mps,
                 {.name = "max_wheel_speed_mps",
                  .range = {0.01, 10.0},
                  .unit = "m/s",
                  .help = "Maximum rim speed of a wheel; both wheels are scaled together, which keeps the curvature"});
    visit.number(self.max_wheel_acceleration_mps2,
                 {.name = "max_wheel_acceleration_mps2",
                  .range = {0.1, 100.0},
                  .unit = "m/s^2",
                  .help = "Maximum acceleration of a wheel; the tires slip above it"});
  }
};

/// Parameters of the built-in play.
struct PlayParameters {
  bool enabled = true;
  int goalkeeper_id = -1;
  double robot_radius_m = 0.0375;
  double ball_radius_m = 0.02135;
  double clearance_m = 0.11;
  double keeper_line_m = 0.045;
  double hysteresis_s = 0.2;
  double max_coast_s = 0.15;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.flag(
        self.enabled,
        {.name = "enabled", .help = "Play the built-in game; false: robots without a command of another program stop"});
    visit.number(self.goalkeeper_id, {.name = "goalkeeper_id",
                                      .range = {-1, 127},
                                      .help = "Id of the goalkeeper; -1: the robot that is soonest in the goal"});
    visit.number(self.robot_radius_m,
                 {.name = "robot_radius_m", .range = {0.005, 0.5}, .unit = "m", .help = "Half the side of a robot"});
    visit.number(self.ball_radius_m,
                 {.name = "ball_radius_m", .range = {0.005, 0.5}, .unit = "m", .help = "Radius of the ball"});
    visit.number(self.clearance_m, {.name = "clearance_m",
                                    .range = {0.01, 1.0},
                                    .unit = "m",
                                    .help = "Minimum distance between the centers of two robots that pass each other"});
    visit.number(self.keeper_line_m, {.name = "keeper_line_m",
                                      .range = {0.0, 1.0},
                                      .unit = "m",
                                      .help = "Distance of the goalkeeper's center from the goal line"});
    visit.number(self.hysteresis_s, {.name = "hysteresis_s",
                                     .range = {0.0, 5.0},
                                     .unit = "s",
                                     .help = "Time by which another robot must be sooner to take over a role"});
    visit.number(self.max_coast_s, {.name = "max_coast_s",
                                    .range = {0.0, 5.0},
                                    .unit = "s",
                                    .help = "Time without a sighting after which a robot gets stop commands"});
  }
};

/// How the ball rolls and bounces, for the play's prediction. Defaults: a golf ball and robots of 0.45 kg, as in the
/// arena's parameter set "mirosot".
struct BallMotionParameters {
  double deceleration_mps2 = 0.12;
  double damping_per_s = 0.35;
  double wall_restitution = 0.6;
  double robot_restitution = 0.6;
  double mass_ratio = 0.1;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.number(self.deceleration_mps2, {.name = "deceleration_mps2",
                                          .range = {0.0, 10.0},
                                          .unit = "m/s^2",
                                          .help = "Deceleration of a rolling ball, whatever its speed"});
    visit.number(self.damping_per_s, {.name = "damping_per_s",
                                      .range = {0.0, 10.0},
                                      .unit = "1/s",
                                      .help = "Further deceleration, divided by the speed"});
    visit.number(self.wall_restitution, {.name = "wall_restitution",
                                         .range = {0.0, 1.0},
                                         .help = "Part of the speed towards a wall that the ball keeps"});
    visit.number(self.robot_restitution, {.name = "robot_restitution",
                                          .range = {0.0, 1.0},
                                          .help = "Part of the speed towards a robot that the ball keeps"});
    visit.number(self.mass_ratio,
                 {.name = "mass_ratio", .range = {0.0, 10.0}, .help = "Mass of the ball, divided by that of a robot"});
  }
};

/// How the team takes its places while the game is stopped. Defaults: rules of the RoboCup Small Size League, sections
/// "Stop" (speed of robots, distance to the ball), "Penalty Kick" and "Defense Area Distance".
struct LineUpParameters {
  double max_speed_mps = 1.5;
  double ball_distance_m = 0.5;
  double penalty_distance_m = 1.0;
  double area_distance_m = 0.2;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.number(self.max_speed_mps, {.name = "max_speed_mps",
                                      .range = {0.05, 10.0},
                                      .unit = "m/s",
                                      .help = "Maximum speed of all own robots while the game is stopped"});
    visit.number(self.ball_distance_m,
                 {.name = "ball_distance_m",
                  .range = {0.05, 5.0},
                  .unit = "m",
                  .help = "Distance to the ball of all robots but the one that takes our restart"});
    visit.number(self.penalty_distance_m,
                 {.name = "penalty_distance_m",
                  .range = {0.0, 5.0},
                  .unit = "m",
                  .help = "Distance behind the ball of the robots that take no part in a penalty kick"});
    visit.number(self.area_distance_m, {.name = "area_distance_m",
                                        .range = {0.0, 5.0},
                                        .unit = "m",
                                        .help = "Distance to the other team's penalty area"});
  }
};

/// Commands of other programs.
struct ExternalParameters {
  double max_age_s = 0.2;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.number(self.max_age_s, {.name = "max_age_s",
                                  .range = {0.02, 2.0},
                                  .unit = "s",
                                  .help = "Age of the last command of another program after which its robot stops"});
  }
};

/// How much robots keep away from others.
enum class Avoidance : std::uint8_t {
  kNormal,  // for games: a contact that others cause, or that only braking in time would avoid, is possible
  kStrict   // for laboratories: a robot moves only if it can stop before each other one, whatever happens next
};
inline constexpr std::array<Choice<Avoidance>, 2> kAvoidances{
    {{"normal", Avoidance::kNormal}, {"strict", Avoidance::kStrict}}};

struct ControlParameters {
  Avoidance avoid = Avoidance::kNormal;
  DriveParameters drive;
  PlayParameters play;
  BallMotionParameters ball;
  LineUpParameters line_up;
  ExternalParameters external;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.choice(
        self.avoid, kAvoidances,
        {.name = "avoid",
         .help = "How robots avoid each other; strict: a robot moves only if it can stop before each other one"});
    visit.section(self.drive, {.name = "drive", .help = "Wheels and limits of the drive"});
    visit.section(self.play, {.name = "play", .help = "Roles and rules of the built-in game"});
    visit.section(self.ball, {.name = "ball", .help = "How the ball rolls and bounces, for predictions of the play"});
    visit.section(self.line_up, {.name = "line_up", .help = "Places and speed while the referee has stopped the game"});
    visit.section(self.external, {.name = "external", .help = "Robots that other programs drive"});
  }
};

}  // namespace touchline
