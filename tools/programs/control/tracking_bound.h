#pragma once

#include "core/pipeline.h"
#include "hal/mock/arena_parameters.h"

namespace touchline::control_evaluation {

/// Returns the RMS distance in m from a trajectory that no causal controller goes below: what the random slip of the
/// wheels moves the robot within `delay_s`, the time from a picture until a command that answers to it has an effect.
/// It is the error of the LQG regulator without noise of the sightings and with free control. Wheel gains are known.
double tracking_bound_m(double speed_mps, double delay_s, const hal::mock::PhysicsParameters& physics);

}  // namespace touchline::control_evaluation
