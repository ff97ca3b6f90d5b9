#pragma once

#include <cmath>
#include <random>

#include "core/geometry/angle.h"
#include "core/types.h"

namespace touchline {

inline Pose pose(double x_m, double y_m, double theta_rad = 0.0) {
  return {{static_cast<float>(x_m), static_cast<float>(y_m)}, static_cast<float>(theta_rad)};
}

inline Instant at(double time_s) { return Instant{} + from_seconds(time_s); }

/// Simulated truth for filter tests: a differential drive with wheel lag and slip, integrated in small steps. Its
/// errors are correlated over time like those of a real drive, not white noise.
class SimulatedRobot {
 public:
  struct Faults {
    double lag_s = 0.08;
    double speed_error = 0.0;  // standard deviation of the relative error of both velocities
    double error_lasts_s = 0.05;
    double slip_m_rts = 0.0;  // drift sideways and forward
  };

  SimulatedRobot(const Faults& faults, unsigned seed) : faults_(faults), random_(seed) {}

  void advance(const Twist& command, double dt_s) {
    constexpr double kStep = 0.0005;
    const int steps = static_cast<int>(std::lround(dt_s / kStep));
    for (int i = 0; i < steps; ++i) {
      if (time_ >= next_error_) {
        v_error_ = faults_.speed_error * normal_(random_);
        w_error_ = faults_.speed_error * normal_(random_);
        next_error_ = time_ + faults_.error_lasts_s;
      }
      const double to_v = static_cast<double>(command.v_mps) * (1.0 + v_error_);
      const double to_w = static_cast<double>(command.w_radps) * (1.0 + w_error_);
      const double follow = faults_.lag_s > 0.0 ? 1.0 - std::exp(-kStep / faults_.lag_s) : 1.0;
      const double mean_v = v + 0.5 * follow * (to_v - v), mean_w = w + 0.5 * follow * (to_w - w);
      v += follow * (to_v - v);
      w += follow * (to_w - w);
      const double slip = faults_.slip_m_rts * std::sqrt(kStep);
      x += kStep * mean_v * std::cos(theta + 0.5 * kStep * mean_w) + slip * normal_(random_);
      y += kStep * mean_v * std::sin(theta + 0.5 * kStep * mean_w) + slip * normal_(random_);
      theta = wrap_angle(theta + kStep * mean_w);
      time_ += kStep;
    }
  }

  [[nodiscard]] Pose pose() const { return {{static_cast<float>(x), static_cast<float>(y)}, wrap_to_float(theta)}; }
  /// Returns the pose as the camera would measure it.
  Pose sighted(double position_sigma_m, double heading_sigma_rad) {
    return {{static_cast<float>(x + position_sigma_m * normal_(random_)),
             static_cast<float>(y + position_sigma_m * normal_(random_))},
            wrap_to_float(theta + heading_sigma_rad * normal_(random_))};
  }

  double x = 0.0, y = 0.0, theta = 0.0, v = 0.0, w = 0.0;

 private:
  Faults faults_;
  std::mt19937 random_;
  std::normal_distribution<double> normal_;
  double time_ = 0.0, next_error_ = 0.0, v_error_ = 0.0, w_error_ = 0.0;
};

/// Returns commands that change every 0.25 s, as in a game.
inline Twist changing_command(double time_s) {
  const int phase = static_cast<int>(time_s / 0.25);
  const double v = 0.8 * std::sin(1.7 * phase), w = 5.0 * std::sin(2.3 * phase + 1.0);
  return {static_cast<float>(v), static_cast<float>(w)};
}

/// Returns the noise of simulated sightings.
inline PoseCovariance sighting_noise(double position_sigma_m = 0.0015, double heading_sigma_rad = 0.02) {
  const auto xx = static_cast<float>(position_sigma_m * position_sigma_m);
  return {xx, xx, static_cast<float>(heading_sigma_rad * heading_sigma_rad), 0.0f, 0.0f, 0.0f};
}

inline RobotSighting sighting_of(Team team, RobotId id, const Pose& pose) {
  RobotSighting sighting;
  sighting.team = team;
  sighting.id = id;
  sighting.confidence = 0.99f;
  sighting.has_heading = true;
  sighting.pose = pose;
  sighting.noise = sighting_noise();
  return sighting;
}

inline RobotSighting patch_alone(Team team, double x, double y) {
  RobotSighting sighting;
  sighting.team = team;
  sighting.confidence = 0.8f;
  sighting.noise = sighting_noise();
  sighting.pose.position = {static_cast<float>(x), static_cast<float>(y)};
  return sighting;
}

}  // namespace touchline
