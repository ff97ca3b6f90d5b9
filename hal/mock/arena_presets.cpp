// Values of the parameter sets; docs/arena.md lists their sources.
#include "hal/mock/arena_parameters.h"

namespace touchline::hal::mock {
namespace {

// FIRASim. Its motors reach every commanded speed at once, so that the tires limit the acceleration. A robot also
// glides on four balls, which oppose its motion but not its turns. Fitted to the recording that
// firasim_recording_test.cpp repeats: mass, inertia, friction of tires, skids and ball, restitution, rolling
// resistance.
void apply_firasim(ArenaParameters& parameters) {
  PhysicsParameters& physics = parameters.physics;
  physics.robot_mass_kg = 0.9;
  physics.ball_mass_kg = 0.043;
  physics.wheel_base_m = 0.085;
  physics.inertia_ratio = 1.14;
  physics.wheel_lag_s = physics.wheel_error = physics.wheel_slip = 0.0;
  physics.tire_friction = 0.455;
  physics.tire_side_friction = 0.57;  // FIRASim's coefficients are 1 sideways and 0.8 along
  physics.skid_friction = 0.325;
  physics.contact_friction = 0.5;
  physics.ball_friction = 0.03;
  physics.ball_robot_friction = 0.06;
  physics.robot_restitution = 0.0;
  // FIRASim's coefficient is 0.5. The ball leaves the wall sliding, with its old spin, and is this slow when it rolls.
  physics.ball_restitution = 0.295;
  physics.ball_robot_restitution = 0.03;
  physics.ball_deceleration_mps2 = 0.0765;
  physics.ball_damping_per_s = physics.floor_roughness_mps_rts = 0.0;
  parameters.robot_side_m = 0.075;
  parameters.ball_radius_m = 0.0215;
  parameters.radio.delay_s = 0.0;
  parameters.radio.jitter_s = parameters.radio.loss = parameters.radio.corruption = 0.0;
}

// rSim is FIRASim's physics with robots of its own; what its source does not state is taken from there.
void apply_rsim(ArenaParameters& parameters) {
  apply_firasim(parameters);
  PhysicsParameters& physics = parameters.physics;
  physics.robot_mass_kg = 0.154;  // body 0.12, wheels 2 x 0.015, skids 4 x 0.001 kg
  physics.wheel_base_m = 0.0775;  // 2 x (0.0375 + 0.0025 / 2) m
  physics.wheel_speed_mps = 1.2;  // 440 rpm, wheel radius 26 mm
  physics.wheel_force_n = 2.79;   // 0.0725 N m over 26 mm
}

}  // namespace

void apply_preset(ArenaPreset preset, ArenaParameters& parameters) {
  const ArenaParameters defaults;
  parameters.physics = defaults.physics;
  parameters.radio = defaults.radio;
  parameters.robot_side_m = defaults.robot_side_m;
  parameters.ball_radius_m = defaults.ball_radius_m;
  switch (preset) {
    case ArenaPreset::kMirosot:
      return;
    case ArenaPreset::kRsim:
      return apply_rsim(parameters);
    case ArenaPreset::kFirasim:
      return apply_firasim(parameters);
  }
}

}  // namespace touchline::hal::mock
