#include "core/identification/wheel_response.h"

#include <cmath>

namespace touchline {

void WheelResponse::advance(double dt_s, double command_mps, const WheelResponseParameters& parameters,
                            WheelTravel& travel) {
  if (!(dt_s > 0.0)) return;
  const double sign = std::abs(command_mps) > parameters.dead_zone_mps ? std::copysign(1.0, command_mps) : 0.0;
  const bool moves = command_mps != 0.0 && sign != 0.0;
  const double input = moves ? command_mps - sign * parameters.dead_zone_mps : 0.0;
  const double input_by_dead_zone = moves ? -sign : 0.0;
  // Part of the initial difference from the input that remains after dt_s, and its integral.
  const double lag = parameters.lag_s, remains = std::exp(-dt_s / lag), integral = lag * (1.0 - remains);
  const double difference = speed_ - input, before = speed_;
  travel.distance_m += input * dt_s + difference * integral;
  travel.by_lag += by_lag_ * integral + difference * ((1.0 - remains) - dt_s / lag * remains);
  travel.by_dead_zone += input_by_dead_zone * dt_s + (by_dead_zone_ - input_by_dead_zone) * integral;
  speed_ = input + difference * remains;
  by_lag_ = remains * (by_lag_ + difference * dt_s / (lag * lag));
  by_dead_zone_ = input_by_dead_zone + (by_dead_zone_ - input_by_dead_zone) * remains;
  // A longer delay shifts the speed in time, so the distance loses what lies at the end and gains what lies at the
  // beginning.
  travel.by_delay -= speed_ - before;
}

}  // namespace touchline
