#pragma once

#include "core/parameter.h"

namespace touchline {

// Noise that grows with time is given as what it adds up to in a second: a density whose unit has a 1/sqrt(s), so that
// frame rate and lost frames change nothing. Klancar's V of eq. (5) at sampling time T is density^2 / T.

/// The filter of one robot, eq. (4)-(9).
struct RobotFilterParameters {
  double position_sigma_m = 0.0015;
  double heading_sigma_rad = 0.02;
  double patch_sigma_m = 0.025;
  double wheel_lag_s = 0.08;
  double drive_noise_m_rts = 0.004;
  double turn_noise_rad_rts = 0.04;
  double drive_error_rts = 0.03;
  double turn_error_rts = 0.04;
  double slip_m_rts = 0.0015;
  double spin_rad_rts = 0.01;
  double free_noise_mps_rts = 1.0;
  double free_noise_radps_rts = 10.0;
  double start_speed_sigma_mps = 0.5;
  double start_turn_sigma_radps = 5.0;
  double max_speed_mps = 3.0;
  double gate_pose = 16.27;
  double gate_position = 13.82;
  int restart_after = 3;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.number("position_sigma_m", self.position_sigma_m, Range{1e-5, 0.1}, "m",
                 "Noise of a sighted position, one axis (standard deviation)");
    visit.number("heading_sigma_rad", self.heading_sigma_rad, Range{1e-4, 1.0}, "rad", "Noise of a sighted heading");
    visit.number("patch_sigma_m", self.patch_sigma_m, Range{1e-4, 0.2}, "m",
                 "How far from the robot's center its team patch may be, when only that was seen");
    visit.number("wheel_lag_s", self.wheel_lag_s, Range{0.0, 1.0}, "s",
                 "Time constant with which a robot's velocities follow the commands");
    visit.number("drive_noise_m_rts", self.drive_noise_m_rts, Range{0.0, 1.0}, "m/sqrt(s)",
                 "Noise at the linear input of a robot told to stand");
    visit.number("turn_noise_rad_rts", self.turn_noise_rad_rts, Range{0.0, 10.0}, "rad/sqrt(s)",
                 "Noise at the angular input of a robot told to stand");
    visit.number("drive_error_rts", self.drive_error_rts, Range{0.0, 1.0}, "sqrt(s)",
                 "Further noise at the linear input, for each m/s");
    visit.number("turn_error_rts", self.turn_error_rts, Range{0.0, 1.0}, "sqrt(s)",
                 "Further noise at the angular input, for each rad/s");
    visit.number("slip_m_rts", self.slip_m_rts, Range{0.0, 1.0}, "m/sqrt(s)",
                 "Drift of the position that no wheel has made");
    visit.number("spin_rad_rts", self.spin_rad_rts, Range{0.0, 10.0}, "rad/sqrt(s)",
                 "Drift of the heading that no wheel has made");
    visit.number("free_noise_mps_rts", self.free_noise_mps_rts, Range{1e-3, 100.0}, "m/s/sqrt(s)",
                 "Change of the speed of a robot whose commands are not known");
    visit.number("free_noise_radps_rts", self.free_noise_radps_rts, Range{1e-3, 1000.0}, "rad/s/sqrt(s)",
                 "Change of the turn rate of a robot whose commands are not known");
    visit.number("start_speed_sigma_mps", self.start_speed_sigma_mps, Range{1e-3, 10.0}, "m/s",
                 "Speed that a robot may have when first seen");
    visit.number("start_turn_sigma_radps", self.start_turn_sigma_radps, Range{1e-3, 100.0}, "rad/s",
                 "Turn rate that a robot may have when first seen");
    visit.number("max_speed_mps", self.max_speed_mps, Range{0.1, 20.0}, "m/s",
                 "No robot is faster: a sighting farther off is believed only when the time has sufficed");
    visit.number("gate_pose", self.gate_pose, Range{1.0, 1e6}, "",
                 "Innovation gate of position and heading (chi-square of 3; 16.27 refuses 1 in 1000)");
    visit.number("gate_position", self.gate_position, Range{1.0, 1e6}, "",
                 "Innovation gate of position alone (chi-square of 2; 13.82 refuses 1 in 1000)");
    visit.number("restart_after", self.restart_after, Range{1, 100}, "",
                 "Refused sightings in a row, near each other, after which the filter starts over there");
  }
};

/// The filter of the ball, eq. (10), (11).
struct BallFilterParameters {
  double position_sigma_m = 0.002;
  double damping_per_s = 0.4;
  double noise_mps_rts = 0.5;
  double start_speed_sigma_mps = 1.0;
  double max_speed_mps = 8.0;
  double gate_position = 13.82;
  int restart_after = 2;
  int confirm_sightings = 2;
  double lost_after_s = 1.0;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.number("position_sigma_m", self.position_sigma_m, Range{1e-5, 0.1}, "m", "Noise of a sighted position");
    visit.number("damping_per_s", self.damping_per_s, Range{0.0, 10.0}, "1/s", "Lambda of eq. (10)");
    visit.number("noise_mps_rts", self.noise_mps_rts, Range{1e-3, 100.0}, "m/s/sqrt(s)",
                 "Change of the velocity that the damping does not explain");
    visit.number("start_speed_sigma_mps", self.start_speed_sigma_mps, Range{1e-3, 20.0}, "m/s",
                 "Speed that the ball may have when first seen");
    visit.number("max_speed_mps", self.max_speed_mps, Range{0.1, 50.0}, "m/s",
                 "No ball is faster: a sighting farther off is believed only when the time has sufficed");
    visit.number("gate_position", self.gate_position, Range{1.0, 1e6}, "",
                 "Innovation gate (chi-square of 2; 13.82 refuses 1 in 1000)");
    visit.number("restart_after", self.restart_after, Range{1, 100}, "",
                 "Refused sightings in a row, near each other, after which the filter starts over there");
    visit.number("confirm_sightings", self.confirm_sightings, Range{1, 100}, "", "Sightings until it counts as seen");
    visit.number("lost_after_s", self.lost_after_s, Range{0.01, 60.0}, "s", "Time without a sighting until lost");
  }
};

struct TrackParameters {
  int confirm_sightings = 3;
  double forget_new_after_s = 0.1;
  double lost_after_s = 0.5;
  double association_m = 0.08;
  double separation_m = 0.05;
  double consistent_m = 0.03;
  RobotFilterParameters robot;
  BallFilterParameters ball;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.number("confirm_sightings", self.confirm_sightings, Range{1, 100}, "",
                 "Sightings until a new robot counts as seen");
    visit.number("forget_new_after_s", self.forget_new_after_s, Range{0.0, 10.0}, "s",
                 "Time without a sighting until a robot that is still new is forgotten");
    visit.number("lost_after_s", self.lost_after_s, Range{0.01, 60.0}, "s",
                 "Time without a sighting until a robot is lost");
    visit.number("association_m", self.association_m, Range{0.0, 1.0}, "m",
                 "A sighting without id belongs to the nearest track within this and three standard deviations");
    visit.number("separation_m", self.separation_m, Range{0.0, 1.0}, "m",
                 "Centers of two robots cannot be nearer; a sighting without id that is, is no robot of its own");
    visit.number("consistent_m", self.consistent_m, Range{0.0, 1.0}, "m",
                 "Refused sightings in a row are one object when no farther apart than this and its possible way");
    visit.section("robot", self.robot, "Filter of a robot");
    visit.section("ball", self.ball, "Filter of the ball");
  }
};

}  // namespace touchline
