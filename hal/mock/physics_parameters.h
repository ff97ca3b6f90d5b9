#pragma once

#include "core/parameter.h"

// Sections [arena.physics] and [arena.radio] of the board file.
namespace touchline::hal::mock {

/// Motion and collisions of robots and ball. The defaults are those of arena.preset = "mirosot" (docs/arena.md).
struct PhysicsParameters {
  double robot_mass_kg = 0.45, ball_mass_kg = 0.046;
  double wheel_base_m = 0.07;
  double wheel_lag_s = 0.08;
  double wheel_error = 0.02;
  double wheel_slip = 0.03;
  double wheel_dead_zone_mps = 0.0;
  double wheel_lag_error = 0.0;
  bool wheels_exchanged = false, left_reversed = false, right_reversed = false;
  double inertia_ratio = 1.0;
  double wheel_speed_mps = 10.0, wheel_force_n = 100.0;
  double tire_friction = 0.8, tire_side_friction = 0.8, skid_friction = 0.0;
  double contact_friction = 0.2, ball_friction = 0.2, ball_robot_friction = 0.2;
  double robot_restitution = 0.1, ball_restitution = 0.6, ball_robot_restitution = 0.6;
  double ball_deceleration_mps2 = 0.12;
  double ball_damping_per_s = 0.35;
  double floor_roughness_mps_rts = 0.01;
  double command_timeout_s = 0.2;
  double free_ball_after_s = 10.0;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.number(self.robot_mass_kg,
                 {.name = "robot_mass_kg", .range = {0.05, 20.0}, .unit = "kg", .help = "Mass of a robot"});
    visit.number(self.ball_mass_kg,
                 {.name = "ball_mass_kg", .range = {0.005, 1.0}, .unit = "kg", .help = "Mass of the ball"});
    visit.number(self.wheel_base_m,
                 {.name = "wheel_base_m", .range = {0.01, 1.0}, .unit = "m", .help = "Distance between the wheels"});
    visit.number(self.wheel_lag_s, {.name = "wheel_lag_s",
                                    .range = {0.0, 1.0},
                                    .unit = "s",
                                    .help = "Time constant of the wheels after a command"});
    visit.number(
        self.wheel_error,
        {.name = "wheel_error", .range = {0.0, 0.2}, .help = "Standard deviation of the wheels' constant gain error"});
    visit.number(self.wheel_slip,
                 {.name = "wheel_slip", .range = {0.0, 0.5}, .help = "Standard deviation of the wheels' random slip"});
    visit.number(
        self.wheel_dead_zone_mps,
        {.name = "wheel_dead_zone_mps",
         .range = {0.0, 0.5},
         .unit = "m/s",
         .help = "Part of a commanded wheel speed that moves nothing, as friction without speed control does"});
    visit.number(self.wheel_lag_error,
                 {.name = "wheel_lag_error",
                  .range = {0.0, 0.5},
                  .help = "Standard deviation of the wheels' constant relative error of the lag"});
    visit.flag(self.wheels_exchanged,
               {.name = "wheels_exchanged",
                .help = "The own robots' commands for the left wheel drive the right one, and vice versa"});
    visit.flag(self.left_reversed, {.name = "left_reversed",
                                    .help = "The motor that gets the own robots' commands for the left wheel turns "
                                            "backward"});
    visit.flag(self.right_reversed, {.name = "right_reversed",
                                     .help = "The motor that gets the own robots' commands for the right wheel turns "
                                             "backward"});
    visit.number(
        self.inertia_ratio,
        {.name = "inertia_ratio",
         .range = {0.1, 10.0},
         .help = "Moment of inertia of a robot, relative to that of a homogeneous square of its mass and side"});
    visit.number(self.wheel_speed_mps, {.name = "wheel_speed_mps",
                                        .range = {0.01, 20.0},
                                        .unit = "m/s",
                                        .help = "Largest speed of a wheel's rim; faster commands are limited to it"});
    visit.number(self.wheel_force_n, {.name = "wheel_force_n",
                                      .range = {0.01, 1000.0},
                                      .unit = "N",
                                      .help = "Largest force of a motor at the wheel's rim: torque over radius"});
    visit.number(
        self.tire_friction,
        {.name = "tire_friction",
         .range = {0.05, 3.0},
         .help = "Friction of both tires together in the direction in which they roll, over the robot's weight"});
    visit.number(self.tire_side_friction,
                 {.name = "tire_side_friction",
                  .range = {0.05, 3.0},
                  .help = "Friction of both tires together sideways, over the robot's weight"});
    visit.number(self.skid_friction,
                 {.name = "skid_friction",
                  .range = {0.0, 1.0},
                  .help = "Friction of what glides over the floor beside the tires, over the robot's weight"});
    visit.number(self.contact_friction, {.name = "contact_friction",
                                         .range = {0.0, 2.0},
                                         .help = "Coefficient of friction of robots with robots and walls"});
    visit.number(
        self.ball_friction,
        {.name = "ball_friction", .range = {0.0, 2.0}, .help = "Coefficient of friction of the ball and walls"});
    visit.number(
        self.ball_robot_friction,
        {.name = "ball_robot_friction", .range = {0.0, 2.0}, .help = "Coefficient of friction of the ball and robots"});
    visit.number(self.robot_restitution,
                 {.name = "robot_restitution", .range = {0.0, 1.0}, .help = "Coefficient of restitution of robots"});
    visit.number(
        self.ball_restitution,
        {.name = "ball_restitution", .range = {0.0, 1.0}, .help = "Coefficient of restitution of the ball and walls"});
    visit.number(self.ball_robot_restitution, {.name = "ball_robot_restitution",
                                               .range = {0.0, 1.0},
                                               .help = "Coefficient of restitution of the ball and robots"});
    visit.number(self.ball_deceleration_mps2, {.name = "ball_deceleration_mps2",
                                               .range = {0.0, 10.0},
                                               .unit = "m/s^2",
                                               .help = "Rolling resistance of the ball"});
    visit.number(self.ball_damping_per_s, {.name = "ball_damping_per_s",
                                           .range = {0.0, 10.0},
                                           .unit = "1/s",
                                           .help = "Damping of the ball, proportional to its speed"});
    visit.number(self.floor_roughness_mps_rts,
                 {.name = "floor_roughness_mps_rts",
                  .range = {0.0, 1.0},
                  .unit = "m/s/sqrt(s)",
                  .help = "Random change of the ball's velocity at 1 m/s and above; slower balls change less"});
    visit.number(self.command_timeout_s, {.name = "command_timeout_s",
                                          .range = {0.02, 10.0},
                                          .unit = "s",
                                          .help = "Time without a valid packet after which a robot stops"});
    visit.number(self.free_ball_after_s, {.name = "free_ball_after_s",
                                          .range = {1.0, 600.0},
                                          .unit = "s",
                                          .help = "Time without motion of the ball after which there is a free ball"});
  }
};

/// The radio link to the robots, and their telemetry.
struct ChannelParameters {
  double delay_s = 0.015;
  double jitter_s = 0.003;
  double loss = 0.02;
  double corruption = 0.01;
  int queue_bytes = 256;
  double telemetry_hz = 2.0;
  double battery_v = 8.2;
  double battery_drop_v_per_min = 0.05;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.number(self.delay_s, {.name = "delay_s",
                                .range = {0.0, 1.0},
                                .unit = "s",
                                .help = "Minimum delay from the last byte of a packet to the robots"});
    visit.number(self.jitter_s, {.name = "jitter_s",
                                 .range = {0.0, 1.0},
                                 .unit = "s",
                                 .help = "Mean of an additional exponentially distributed delay"});
    visit.number(
        self.loss,
        {.name = "loss", .range = {0.0, 1.0}, .help = "Fraction of the packets that a robot does not receive"});
    visit.number(
        self.corruption,
        {.name = "corruption", .range = {0.0, 1.0}, .help = "Fraction of the packets that arrive with wrong bits"});
    visit.number(self.queue_bytes, {.name = "queue_bytes",
                                    .range = {128, 65536},
                                    .help = "Size of the transmit queue; further bytes are rejected"});
    visit.number(self.telemetry_hz,
                 {.name = "telemetry_hz",
                  .range = {0.0, 50.0},
                  .unit = "Hz",
                  .help = "Rate at which each own robot sends telemetry, with the same losses; 0: never"});
    visit.number(self.battery_v, {.name = "battery_v",
                                  .range = {0.0, 60.0},
                                  .unit = "V",
                                  .help = "Battery voltage at the start; each robot has up to 0.3 V less"});
    visit.number(self.battery_drop_v_per_min,
                 {.name = "battery_drop_v_per_min",
                  .range = {0.0, 60.0},
                  .unit = "V/min",
                  .help = "Discharge of the battery; motors take a further 0.3 V at 1 m/s"});
  }
};

}  // namespace touchline::hal::mock
