#pragma once

// The parameters of the built-in play of release 0.1, with the defaults of that release.
namespace touchline::release_0_1 {

/// Limits of a robot's drive. Defaults: a MiroSot or VSS robot of 75 mm with two motors.
struct DriveParameters {
  double wheel_base_m = 0.07;
  double max_speed_mps = 1.2;
  double max_turn_radps = 14.0;
  double max_wheel_speed_mps = 1.4;
  double max_wheel_acceleration_mps2 = 4.0;
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
};

/// Parameters of the default game.
struct PlayParameters {
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
  double stuck_after_s = 0.6;
  double escape_for_s = 0.35;
  double escape_speed_mps = 0.4;
};

struct ControlParameters {
  DriveParameters drive;
  MotionParameters motion;
  PlayParameters play;
};

}  // namespace touchline::release_0_1
