#pragma once

namespace touchline {

/// Parameters of a wheel's response to its commands.
struct WheelResponseParameters {
  double lag_s = 0.08;         // time constant, > 0
  double dead_zone_mps = 0.0;  // part of a command that moves nothing
};

/// Distance that a wheel with a gain of 1 drives, and its derivatives by the parameters of the response.
struct WheelTravel {
  double distance_m = 0.0, by_delay = 0.0, by_lag = 0.0, by_dead_zone = 0.0;
};

/// Speed of a wheel with a gain of 1 that follows piecewise constant commands, and its derivatives by the parameters.
/// The speed w follows the command u, reduced by the dead zone, like a first-order lag: dw/dt = (u - w) / lag. All
/// values are the exact solutions of this equation.
class WheelResponse {
 public:
  /// Advances by dt_s >= 0 under a constant command and adds the distance to `travel`. The caller delays the commands.
  void advance(double dt_s, double command_mps, const WheelResponseParameters& parameters, WheelTravel& travel);
  [[nodiscard]] double speed_mps() const { return speed_; }

 private:
  double speed_ = 0.0, by_lag_ = 0.0, by_dead_zone_ = 0.0;
};

}  // namespace touchline
