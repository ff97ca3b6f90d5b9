#pragma once

#include "core/parameter.h"

namespace touchline {

// Process noise is given as a spectral density: the standard deviation after one second, in a unit that contains
// 1/sqrt(s). It therefore does not depend on frame rate or lost frames. Klancar's V of eq. (5) at sampling time T is
// density^2 / T.

/// The filter of one robot, eq. (4)-(9).
struct RobotFilterParameters {
  double position_sigma_m = 0.00003;
  double heading_sigma_rad = 0.0009;
  double position_jitter_m = 0.000005;
  double heading_jitter_rad = 0.0001;
  double motion_sigma_s = 0.000045;
  double patch_sigma_m = 0.025;
  double wheel_lag_s = 0.08;
  double tire_grip_mps2 = 7.8;
  double slide_noise_mps_rts = 0.3;
  double contact_noise_mps_rts = 0.5;
  double contacts_per_s = 0.5;
  double contact_lasts_s = 0.2;
  double drive_noise_m_rts = 0.004;
  double turn_noise_rad_rts = 0.04;
  double drive_error_rts = 0.03;
  double turn_error_rts = 0.04;
  double veer_error_rts_per_m = 0.2;
  double slip_m_rts = 0.0015;
  double spin_rad_rts = 0.01;
  double free_noise_mps_rts = 1.0;
  double free_noise_radps_rts = 10.0;
  double start_speed_sigma_mps = 0.5;
  double start_turn_sigma_radps = 5.0;
  double impact_mps = 1.0;
  double impact_radps = 10.0;
  double max_speed_mps = 3.0;
  double gate_pose = 16.27;
  double gate_position = 13.82;
  int restart_after = 3;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.number(self.position_sigma_m, {.name = "position_sigma_m",
                                         .range = {1e-5, 0.1},
                                         .unit = "m",
                                         .help = "Standard deviation of a sighted position's bias, which lasts while "
                                                 "the robot stands, each axis; the picture's own noise adds to it"});
    visit.number(self.heading_sigma_rad, {.name = "heading_sigma_rad",
                                          .range = {1e-4, 1.0},
                                          .unit = "rad",
                                          .help = "Standard deviation of a sighted heading's bias, which lasts while "
                                                  "the robot stands; the picture's own noise adds to it"});
    visit.number(self.position_jitter_m,
                 {.name = "position_jitter_m",
                  .range = {1e-6, 0.1},
                  .unit = "m",
                  .help = "Standard deviation of a sighted position's noise from picture to picture, each axis; the "
                          "picture's own noise and noise.robot_position_m of the venue file add to it"});
    visit.number(self.heading_jitter_rad,
                 {.name = "heading_jitter_rad",
                  .range = {1e-5, 1.0},
                  .unit = "rad",
                  .help = "Standard deviation of a sighted heading's noise from picture to picture; the picture's own "
                          "noise and noise.robot_heading_rad of the venue file add to it"});
    visit.number(
        self.motion_sigma_s,
        {.name = "motion_sigma_s",
         .range = {0.0, 0.1},
         .unit = "s",
         .help = "Error of a moving robot's sighting by motion blur and the time stamp: the standard deviation of the "
                 "position is this time multiplied by the speed; that of the heading grows in proportion"});
    visit.number(self.patch_sigma_m,
                 {.name = "patch_sigma_m",
                  .range = {1e-4, 0.2},
                  .unit = "m",
                  .help = "Standard deviation of the robot's center when only its team patch was seen"});
    visit.number(self.wheel_lag_s,
                 {.name = "wheel_lag_s",
                  .range = {0.0, 1.0},
                  .unit = "s",
                  .help = "Time constant of the robot's velocities after a command; measure it on your robots"});
    visit.number(self.tire_grip_mps2,
                 {.name = "tire_grip_mps2",
                  .range = {0.0, 100.0},
                  .unit = "m/s^2",
                  .help = "Acceleration in any direction at which the tires begin to slide: their coefficient of "
                          "friction times 9.81 m/s^2; 0: they never slide"});
    visit.number(self.slide_noise_mps_rts, {.name = "slide_noise_mps_rts",
                                            .range = {0.0, 100.0},
                                            .unit = "m/s/sqrt(s)",
                                            .help = "Process noise of the velocity of a sliding robot, each axis"});
    visit.number(
        self.contact_noise_mps_rts,
        {.name = "contact_noise_mps_rts",
         .range = {0.0, 100.0},
         .unit = "m/s/sqrt(s)",
         .help = "Process noise of the velocity of a robot in contact with a wall or another robot, each axis"});
    visit.number(self.contacts_per_s, {.name = "contacts_per_s",
                                       .range = {1e-6, 100.0},
                                       .unit = "1/s",
                                       .help = "Rate at which a robot touches a wall or another robot"});
    visit.number(self.contact_lasts_s, {.name = "contact_lasts_s",
                                        .range = {1e-3, 100.0},
                                        .unit = "s",
                                        .help = "Mean duration of a contact with a wall or another robot"});
    visit.number(self.drive_noise_m_rts,
                 {.name = "drive_noise_m_rts",
                  .range = {0.0, 1.0},
                  .unit = "m/sqrt(s)",
                  .help = "Process noise of the linear velocity of a robot with stop commands"});
    visit.number(self.turn_noise_rad_rts,
                 {.name = "turn_noise_rad_rts",
                  .range = {0.0, 10.0},
                  .unit = "rad/sqrt(s)",
                  .help = "Process noise of the angular velocity of a robot with stop commands"});
    visit.number(self.drive_error_rts, {.name = "drive_error_rts",
                                        .range = {0.0, 1.0},
                                        .unit = "sqrt(s)",
                                        .help = "Additional process noise of the linear velocity per m/s"});
    visit.number(self.turn_error_rts, {.name = "turn_error_rts",
                                       .range = {0.0, 1.0},
                                       .unit = "sqrt(s)",
                                       .help = "Additional process noise of the angular velocity per rad/s"});
    visit.number(self.veer_error_rts_per_m,
                 {.name = "veer_error_rts_per_m",
                  .range = {0.0, 10.0},
                  .unit = "sqrt(s)/m",
                  .help = "Additional process noise of the angular velocity per m/s: unequal wheels"});
    visit.number(self.slip_m_rts,
                 {.name = "slip_m_rts",
                  .range = {0.0, 1.0},
                  .unit = "m/sqrt(s)",
                  .help = "Process noise of the position: motion without the wheels, such as slip and pushes"});
    visit.number(self.spin_rad_rts, {.name = "spin_rad_rts",
                                     .range = {0.0, 10.0},
                                     .unit = "rad/sqrt(s)",
                                     .help = "Process noise of the heading: rotation without the wheels"});
    visit.number(self.free_noise_mps_rts,
                 {.name = "free_noise_mps_rts",
                  .range = {1e-3, 100.0},
                  .unit = "m/s/sqrt(s)",
                  .help = "Process noise of the speed of a robot without known commands (opponents)"});
    visit.number(self.free_noise_radps_rts,
                 {.name = "free_noise_radps_rts",
                  .range = {1e-3, 1000.0},
                  .unit = "rad/s/sqrt(s)",
                  .help = "Process noise of the angular velocity of a robot without known commands (opponents)"});
    visit.number(self.start_speed_sigma_mps, {.name = "start_speed_sigma_mps",
                                              .range = {1e-3, 10.0},
                                              .unit = "m/s",
                                              .help = "Standard deviation of the speed when a robot is first seen"});
    visit.number(self.start_turn_sigma_radps,
                 {.name = "start_turn_sigma_radps",
                  .range = {1e-3, 100.0},
                  .unit = "rad/s",
                  .help = "Standard deviation of the angular velocity when a robot is first seen"});
    visit.number(self.impact_mps,
                 {.name = "impact_mps",
                  .range = {1e-3, 20.0},
                  .unit = "m/s",
                  .help = "Standard deviation of the change of the velocity in a collision, each axis"});
    visit.number(self.impact_radps,
                 {.name = "impact_radps",
                  .range = {1e-3, 200.0},
                  .unit = "rad/s",
                  .help = "Standard deviation of the change of the angular velocity in a collision"});
    visit.number(self.max_speed_mps,
                 {.name = "max_speed_mps",
                  .range = {0.1, 20.0},
                  .unit = "m/s",
                  .help = "Maximum speed of a robot; sightings that would need a higher speed are rejected"});
    visit.number(self.gate_pose, {.name = "gate_pose",
                                  .range = {1.0, 1e6},
                                  .help = "Innovation gate of position and heading (chi-square with 3 degrees of "
                                          "freedom; 16.27 rejects 1 in 1000)"});
    visit.number(
        self.gate_position,
        {.name = "gate_position",
         .range = {1.0, 1e6},
         .help =
             "Innovation gate of the position alone (chi-square with 2 degrees of freedom; 13.82 rejects 1 in 1000)"});
    visit.number(
        self.restart_after,
        {.name = "restart_after",
         .range = {1, 100},
         .help = "Number of consecutive rejected sightings, near each other, after which the filter restarts there"});
  }
};

/// The filter of the ball, eq. (10), (11).
struct BallFilterParameters {
  double position_sigma_m = 0.0001;
  double position_jitter_m = 0.000005;
  double damping_per_s = 0.4;
  double noise_mps_rts = 0.5;
  double start_speed_sigma_mps = 1.0;
  double impact_mps = 1.5;
  double max_speed_mps = 8.0;
  double gate_position = 13.82;
  int restart_after = 2;
  int confirm_sightings = 2;
  double lost_after_s = 1.0;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.number(self.position_sigma_m, {.name = "position_sigma_m",
                                         .range = {1e-5, 0.1},
                                         .unit = "m",
                                         .help = "Standard deviation of a sighted position's bias, which lasts while "
                                                 "the ball rests, each axis; the picture's own noise adds to it"});
    visit.number(self.position_jitter_m,
                 {.name = "position_jitter_m",
                  .range = {1e-6, 0.1},
                  .unit = "m",
                  .help = "Standard deviation of a sighted position's noise from picture to picture, each axis; the "
                          "picture's own noise and noise.ball_position_m of the venue file add to it"});
    visit.number(self.damping_per_s, {.name = "damping_per_s",
                                      .range = {0.0, 10.0},
                                      .unit = "1/s",
                                      .help = "Damping of the ball's speed: lambda of Klancar eq. (10)"});
    visit.number(self.noise_mps_rts,
                 {.name = "noise_mps_rts",
                  .range = {1e-3, 100.0},
                  .unit = "m/s/sqrt(s)",
                  .help = "Process noise of the velocity of a ball that robots fight for; it falls while the "
                          "ball rolls freely"});
    visit.number(self.start_speed_sigma_mps, {.name = "start_speed_sigma_mps",
                                              .range = {1e-3, 20.0},
                                              .unit = "m/s",
                                              .help = "Standard deviation of the speed when the ball is first seen"});
    visit.number(
        self.impact_mps,
        {.name = "impact_mps",
         .range = {1e-3, 50.0},
         .unit = "m/s",
         .help = "Standard deviation of the change of the velocity when the ball bounces or is hit, each axis"});
    visit.number(self.max_speed_mps,
                 {.name = "max_speed_mps",
                  .range = {0.1, 50.0},
                  .unit = "m/s",
                  .help = "Maximum speed of the ball; sightings that would need a higher speed are rejected"});
    visit.number(self.gate_position,
                 {.name = "gate_position",
                  .range = {1.0, 1e6},
                  .help = "Innovation gate (chi-square with 2 degrees of freedom; 13.82 rejects 1 in 1000)"});
    visit.number(
        self.restart_after,
        {.name = "restart_after",
         .range = {1, 100},
         .help = "Number of consecutive rejected sightings, near each other, after which the filter restarts there"});
    visit.number(self.confirm_sightings, {.name = "confirm_sightings",
                                          .range = {1, 100},
                                          .help = "Number of sightings after which the ball counts as seen"});
    visit.number(self.lost_after_s, {.name = "lost_after_s",
                                     .range = {0.01, 60.0},
                                     .unit = "s",
                                     .help = "Time without a sighting after which the ball is lost"});
  }
};

struct TrackParameters {
  int confirm_sightings = 3;
  double forget_new_after_s = 0.1;
  double lost_after_s = 0.5;
  double association_m = 0.08;
  double separation_m = 0.05;
  double consistent_m = 0.03;
  bool estimate_drive = true;
  RobotFilterParameters robot;
  BallFilterParameters ball;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.number(self.confirm_sightings, {.name = "confirm_sightings",
                                          .range = {1, 100},
                                          .help = "Number of sightings after which a new robot counts as seen"});
    visit.number(self.forget_new_after_s,
                 {.name = "forget_new_after_s",
                  .range = {0.0, 10.0},
                  .unit = "s",
                  .help = "Time without a sighting after which a robot that does not count as seen yet is forgotten"});
    visit.number(self.lost_after_s, {.name = "lost_after_s",
                                     .range = {0.01, 60.0},
                                     .unit = "s",
                                     .help = "Time without a sighting after which a robot is lost"});
    visit.number(self.association_m, {.name = "association_m",
                                      .range = {0.0, 1.0},
                                      .unit = "m",
                                      .help = "Maximum distance, in addition to three standard deviations, between a "
                                              "sighting without id and its track"});
    visit.number(
        self.separation_m,
        {.name = "separation_m",
         .range = {0.0, 1.0},
         .unit = "m",
         .help = "Minimum distance between the centers of two robots; a nearer sighting without id starts no track"});
    visit.number(self.consistent_m, {.name = "consistent_m",
                                     .range = {0.0, 1.0},
                                     .unit = "m",
                                     .help = "Maximum distance between consecutive rejected sightings of one object, "
                                             "in addition to its possible motion"});
    visit.flag(self.estimate_drive,
               {.name = "estimate_drive",
                .help = "Measure delay, lag and wheel gains while robots play, and use what contradicts the files"});
    visit.section(self.robot, {.name = "robot", .help = "Filter of a robot, Klancar eq. (4) to (9)"});
    visit.section(self.ball, {.name = "ball", .help = "Filter of the ball, Klancar eq. (10) and (11)"});
  }
};

}  // namespace touchline
