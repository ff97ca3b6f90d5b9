#pragma once

#include "core/types.h"

namespace touchline {

/// Kalman filter of a point with damped velocity, eq. (10), (11): the ball, or a robot whose heading is unknown. The
/// two axes are independent and have equal noise, so they share one covariance of position and velocity.
///
/// A part of a sighting's error may be a bias that lasts while the point stands (the lasting error). As in DriveFilter,
/// the filter does not estimate it, but keeps its covariance with the state ("consider" filter, Schmidt 1966).
class PointFilter {
 public:
  struct Noise {
    double position_sigma_m = 0.0;  // standard deviation of a sighting along one axis, without its lasting error
    double velocity_mps_rts = 0.0;  // standard deviation of the velocity's change in one second
    double damping_per_s = 0.0;     // lambda of eq. (10)
  };
  struct Velocity {
    double x_mps = 0.0, y_mps = 0.0, sigma_mps = 0.0;
  };

  /// `lasting_sigma_m`: standard deviation of the sighting's lasting error.
  void start(FieldPoint position, const Velocity& velocity, double position_sigma_m, double lasting_sigma_m = 0.0);
  /// Keeps this share (0 to 1) of the lasting error. An independent new error with this standard deviation replaces the
  /// rest.
  void renew_lasting_error(double part, double lasting_sigma_m);
  /// Predicts with eq. (5) and the model of eq. (11); dt_s >= 0.
  void predict(double dt_s, const Noise& noise);
  /// Returns the variance of the innovation along one axis.
  [[nodiscard]] double innovation_variance(const Noise& noise) const;
  /// Returns the squared Mahalanobis distance of a sighting from the prediction (chi-square with 2 degrees of freedom).
  [[nodiscard]] double distance2(FieldPoint sighted, const Noise& noise) const;
  /// Adds the uncertainty of an impact at an unknown instant during the last dt_s seconds. `change_mps`: standard
  /// deviation of the change of the velocity along each axis.
  void disturb(double dt_s, double change_mps);
  /// Changes only the position.
  void shift_to(FieldPoint position);
  /// Updates the state with eq. (6).
  void update(FieldPoint sighted, const Noise& noise);

  [[nodiscard]] double x_m() const { return x_; }
  [[nodiscard]] double y_m() const { return y_; }
  [[nodiscard]] double vx_mps() const { return vx_; }
  [[nodiscard]] double vy_mps() const { return vy_; }
  [[nodiscard]] FieldPoint position() const { return {static_cast<float>(x_), static_cast<float>(y_)}; }
  [[nodiscard]] FieldPoint velocity() const { return {static_cast<float>(vx_), static_cast<float>(vy_)}; }
  [[nodiscard]] double position_variance() const { return p_; }
  [[nodiscard]] double cross_covariance() const { return c_; }
  [[nodiscard]] double velocity_variance() const { return q_; }

  /// See Pipeline::visit_state().
  template <class Self, class Archive>
  static void visit_state(Self& self, Archive& archive) {
    auto& [x, y, vx, vy, p, c, q, lasting, p_lasting, q_lasting] = self;
    archive(x, y, vx, vy, p, c, q, lasting, p_lasting, q_lasting);
  }

 private:
  double x_ = 0.0, y_ = 0.0, vx_ = 0.0, vy_ = 0.0;
  double p_ = 1.0, c_ = 0.0, q_ = 1.0;  // covariance of each axis: position, cross term, velocity
  double lasting_ = 0.0;                // variance of the lasting error of each axis
  // Covariances of the lasting error with the errors of position and velocity.
  double p_lasting_ = 0.0, q_lasting_ = 0.0;
};

}  // namespace touchline
