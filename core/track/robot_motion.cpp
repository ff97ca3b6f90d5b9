#include "core/track/robot_motion.h"

#include <algorithm>
#include <cmath>

#include "core/geometry/angle.h"

namespace touchline {
namespace {

// Rotation after which the correlation of the lasting errors of position and heading is 1/e. These errors depend on the
// angles between the patches' edges and the pixel grid. The values were measured in games of the arena.
constexpr double kPositionLasts_rad = 0.6, kHeadingLasts_rad = 0.1;
// Below this correlation, lasting errors count as independent.
constexpr double kMinErrorCorrelation = 0.1;
// If the stated variance changes by more than this factor, the sighting shows other parts of the robot.
constexpr float kOtherSize = 4.0f;

bool has_other_size(const PoseCovariance& a, const PoseCovariance& b) {
  const float now = a.xx + a.yy, before = b.xx + b.yy;
  return now > kOtherSize * before || before > kOtherSize * now;
}

}  // namespace

void RobotMotion::start(const Pose& pose, const DriveFilter::Velocity& velocity, double position_sigma_m,
                        double heading_sigma_rad) {
  free_.start(pose, velocity, position_sigma_m, heading_sigma_rad);
  contact_ = free_;
  contact_probability_ = unmixed_s_ = 0.0;
  lasting_ = {};
  lasting_since_ = pose;
  same_position_ = same_heading_ = 1.0;
}

void RobotMotion::start(const Pose& pose, const DriveFilter::Velocity& velocity, const SightingNoise& noise) {
  start(pose, velocity, 0.0, 0.0);
  free_.start(pose, velocity, noise.white, noise.lasting);
  contact_ = free_;
  lasting_ = noise.lasting;
}

// The correlation of the errors at two poses depends only on these poses, not on the path or the time between them. A
// path length would grow with the noise of a standing robot's sightings.
void RobotMotion::renew_lasting_error(const Pose& sighted, const SightingNoise& noise) {
  const Pose& since = lasting_since_;
  const double moved = std::hypot(static_cast<double>(sighted.position.x_m - since.position.x_m),
                                  static_cast<double>(sighted.position.y_m - since.position.y_m));
  const double turned = std::abs(wrap_angle(static_cast<double>(sighted.theta_rad - since.theta_rad)));
  const bool is_other = !(noise.lasts_m > 0.0) || has_other_size(noise.lasting, lasting_);
  const double same = is_other ? 0.0 : std::exp(-moved / noise.lasts_m);
  const double same_position = std::min(same_position_, same * std::exp(-turned / kPositionLasts_rad));
  const double same_heading = std::min(same_heading_, same * std::exp(-turned / kHeadingLasts_rad));
  const double position_part = same_position / same_position_, heading_part = same_heading / same_heading_;
  same_position_ = same_position;
  same_heading_ = same_heading;
  if (same_heading < kMinErrorCorrelation) {
    lasting_since_ = sighted;
    same_position_ = same_heading_ = 1.0;
  }
  free_.renew_lasting_error(position_part, heading_part);
  contact_.renew_lasting_error(position_part, heading_part);
  const double new_position = std::sqrt(1.0 - position_part * position_part);
  const double new_heading = std::sqrt(1.0 - heading_part * heading_part);
  const auto renew = [](float& variance, float now, double part, double fresh) {
    variance = static_cast<float>(part) * variance + static_cast<float>(fresh) * now;
  };
  renew(lasting_.xx, noise.lasting.xx, position_part * position_part, new_position * new_position);
  renew(lasting_.yy, noise.lasting.yy, position_part * position_part, new_position * new_position);
  renew(lasting_.xy, noise.lasting.xy, position_part * position_part, new_position * new_position);
  renew(lasting_.tt, noise.lasting.tt, heading_part * heading_part, new_heading * new_heading);
  renew(lasting_.xt, noise.lasting.xt, position_part * heading_part, new_position * new_heading);
  renew(lasting_.yt, noise.lasting.yt, position_part * heading_part, new_position * new_heading);
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

DriveFilter::Innovation RobotMotion::innovation(const Pose& sighted, const PoseCovariance& noise) const {
  return free_.mixed_innovation(contact_, contact_probability_, sighted, noise, lasting_);
}

void RobotMotion::update(const Pose& sighted, const PoseCovariance& noise, const RobotFilterParameters& parameters) {
  const double more = free_.update(sighted, noise, lasting_) - contact_.update(sighted, noise, lasting_);
  const double p = contact_probability_;
  const double contact = p / (p + (1.0 - p) * std::exp(std::clamp(more, -30.0, 30.0)));
  // Joint probabilities of the model now and the model at the next sighting.
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
