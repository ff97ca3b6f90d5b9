#include "core/track/point_filter.h"

namespace touchline {

void PointFilter::start(FieldPoint position, const Velocity& velocity, double position_sigma_m,
                        double lasting_sigma_m) {
  x_ = static_cast<double>(position.x_m);
  y_ = static_cast<double>(position.y_m);
  vx_ = velocity.x_mps;
  vy_ = velocity.y_mps;
  lasting_ = lasting_sigma_m * lasting_sigma_m;
  p_ = position_sigma_m * position_sigma_m + lasting_;
  c_ = 0.0;
  q_ = velocity.sigma_mps * velocity.sigma_mps;
  // The sign is negative, because errors are the truth minus the estimate.
  p_lasting_ = -lasting_;
  q_lasting_ = 0.0;
}

void PointFilter::renew_lasting_error(double part, double lasting_sigma_m) {
  lasting_ = part * part * lasting_ + (1.0 - part * part) * lasting_sigma_m * lasting_sigma_m;
  p_lasting_ *= part;
  q_lasting_ *= part;
}

void PointFilter::predict(double dt_s, const Noise& noise) {
  const double g = 1.0 / (1.0 + dt_s * noise.damping_per_s);
  vx_ *= g;
  vy_ *= g;
  x_ += dt_s * vx_;
  y_ += dt_s * vy_;
  // A P A' with A = [1 gT; 0 g].
  const double h = g * dt_s;
  p_ += 2.0 * h * c_ + h * h * q_;
  c_ = g * (c_ + h * q_);
  q_ *= g * g;
  p_lasting_ += h * q_lasting_;
  q_lasting_ *= g;
  // White noise acceleration of constant density (Bar-Shalom, Li, Kirubarajan 2001, section 6.2).
  const double density = noise.velocity_mps_rts * noise.velocity_mps_rts;
  p_ += density * dt_s * dt_s * dt_s / 3.0;
  c_ += density * dt_s * dt_s / 2.0;
  q_ += density * dt_s;
}

// The change happens at a uniformly distributed time in the step. A ball bounces, so its velocity may change by more
// than its displacement since the last sighting shows.
void PointFilter::disturb(double dt_s, double change_mps) {
  const double change = change_mps * change_mps;
  p_ += change * dt_s * dt_s / 3.0;
  c_ += change * dt_s / 2.0;
  q_ += change;
}

void PointFilter::shift_to(FieldPoint position) {
  x_ = static_cast<double>(position.x_m);
  y_ = static_cast<double>(position.y_m);
}

double PointFilter::innovation_variance(const Noise& noise) const {
  return p_ + 2.0 * p_lasting_ + lasting_ + noise.position_sigma_m * noise.position_sigma_m;
}

double PointFilter::distance2(FieldPoint sighted, const Noise& noise) const {
  const double dx = static_cast<double>(sighted.x_m) - x_, dy = static_cast<double>(sighted.y_m) - y_;
  return (dx * dx + dy * dy) / innovation_variance(noise);
}

void PointFilter::update(FieldPoint sighted, const Noise& noise) {
  const double s = innovation_variance(noise), n = noise.position_sigma_m * noise.position_sigma_m + lasting_;
  const double k = (p_ + p_lasting_) / s, m = (c_ + q_lasting_) / s;
  const double dx = static_cast<double>(sighted.x_m) - x_, dy = static_cast<double>(sighted.y_m) - y_;
  x_ += k * dx;
  y_ += k * dy;
  vx_ += m * dx;
  vy_ += m * dy;
  // Covariance of (I - K H) times the state's errors with the lasting error.
  const double p_rest = (1.0 - k) * p_lasting_, q_rest = q_lasting_ - m * p_lasting_;
  // Joseph form: the covariance stays positive despite rounding.
  const double p = (1.0 - k) * (1.0 - k) * p_ + k * k * n - 2.0 * k * p_rest;
  const double c = (1.0 - k) * (c_ - m * p_) + k * m * n - m * p_rest - k * q_rest;
  const double q = q_ - 2.0 * m * c_ + m * m * p_ + m * m * n - 2.0 * m * q_rest;
  p_ = p;
  c_ = c;
  q_ = q;
  p_lasting_ = p_rest - k * lasting_;
  q_lasting_ = q_rest - m * lasting_;
}

}  // namespace touchline
