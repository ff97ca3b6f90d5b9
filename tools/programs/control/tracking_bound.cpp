#include "tools/programs/control/tracking_bound.h"

#include <cmath>

namespace touchline::control_evaluation {

double tracking_bound_m(double speed_mps, double delay_s, const hal::mock::PhysicsParameters& physics) {
  // Slip of each wheel: an Ornstein-Uhlenbeck process with this correlation time (hal/mock/world.cpp), known at the
  // beginning. Along: (way, slip). Aside: (distance, heading, slip).
  constexpr double kSlip_s = 0.05, kStep = 1e-4;
  const double v_sigma = speed_mps * physics.wheel_slip / std::sqrt(2.0);
  const double w_sigma = speed_mps * physics.wheel_slip * std::sqrt(2.0) / physics.wheel_base_m;
  double xx = 0.0, xs = 0.0, ss = 0.0;                                // along
  double nn = 0.0, nt = 0.0, nw = 0.0, tt = 0.0, tw = 0.0, ww = 0.0;  // aside
  for (double time = 0.0; time < delay_s; time += kStep) {
    xx += kStep * 2.0 * xs;
    xs += kStep * (ss - xs / kSlip_s);
    ss += kStep * 2.0 / kSlip_s * (v_sigma * v_sigma - ss);
    nn += kStep * 2.0 * speed_mps * nt;
    nt += kStep * (speed_mps * tt + nw);
    nw += kStep * (speed_mps * tw - nw / kSlip_s);
    tt += kStep * 2.0 * tw;
    tw += kStep * (ww - tw / kSlip_s);
    ww += kStep * 2.0 / kSlip_s * (w_sigma * w_sigma - ww);
  }
  return std::sqrt(xx + nn);
}

}  // namespace touchline::control_evaluation
