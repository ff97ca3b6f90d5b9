#include "core/track/robot_motion.h"

#include <algorithm>
#include <cmath>

namespace touchline {

void RobotMotion::start(const Pose& pose, const DriveFilter::Velocity& velocity, double position_sigma_m,
                        double heading_sigma_rad) {
  free_.start(pose, velocity, position_sigma_m, heading_sigma_rad);
  contact_ = free_;
  contact_probability_ = unmixed_s_ = 0.0;
}

void RobotMotion::predict(double dt_s, const DriveInput& input, const RobotFilterParameters& parameters) {
  free_.predict(dt_s, input, parameters);
  contact_.predict_contact(dt_s, parameters);
  unmixed_s_ += dt_s;
}

void RobotMotion::predict_state(double dt_s, const DriveInput& input, const RobotFilterParameters& parameters) {
  free_.predict_state(dt_s, input, parameters);
  contact_.predict_contact_state(dt_s, parameters);
  contact_probability_ *= std::exp(-dt_s / parameters.contact_lasts_s);
}

void RobotMotion::disturb(double dt_s, const RobotFilterParameters& parameters) {
  free_.disturb(dt_s, parameters);
  contact_.disturb(dt_s, parameters);
}

void RobotMotion::scale_covariance(double factor) {
  free_.scale_covariance(factor);
  contact_.scale_covariance(factor);
}

void RobotMotion::shift_to(FieldPoint position) {
  free_.shift_to(position);
  contact_.shift_to(position);
}

double RobotMotion::sigma(std::size_t i) const {
  return std::sqrt(std::max(0.0, free_.mixed_covariance(contact_, contact_probability_, i, i)));
}

double RobotMotion::xy_covariance() const { return free_.mixed_covariance(contact_, contact_probability_, 0, 1); }

double RobotMotion::distance2(const Pose& sighted, const PoseCovariance& noise) const {
  return both().distance2(sighted, noise);
}

void RobotMotion::update(const Pose& sighted, const PoseCovariance& noise, const RobotFilterParameters& parameters) {
  const double more = free_.log_likelihood(sighted, noise) - contact_.log_likelihood(sighted, noise);
  const double p = contact_probability_;
  const double contact = p / (p + (1.0 - p) * std::exp(std::clamp(more, -30.0, 30.0)));
  free_.update(sighted, noise);
  contact_.update(sighted, noise);
  // Joint probabilities of the model now and at the next sighting.
  const double begins = (1.0 - contact) * -std::expm1(-unmixed_s_ * parameters.contacts_per_s);
  const double ends = contact * -std::expm1(-unmixed_s_ / parameters.contact_lasts_s);
  const double next = contact - ends + begins;
  const DriveFilter free = free_.mixed(contact_, ends / (1.0 - next));
  if (next > 0.0) contact_ = contact_.mixed(free_, begins / next);
  free_ = free;
  contact_probability_ = next;
  unmixed_s_ = 0.0;
}

double RobotMotion::distance2(FieldPoint patch, const RobotFilterParameters& parameters) const {
  return both().distance2(patch, parameters);
}

void RobotMotion::update(FieldPoint patch, const RobotFilterParameters& parameters) {
  free_.update(patch, parameters);
  contact_.update(patch, parameters);
}

}  // namespace touchline
