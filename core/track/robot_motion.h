#pragma once

#include "core/track/drive_filter.h"

namespace touchline {

/// Covariances of the errors of a sighted pose: white noise, and a bias that lasts while the robot stands (the lasting
/// error). The bias decorrelates while the robot moves: after `lasts_m`, its correlation with the former bias is 1/e.
struct SightingNoise {
  PoseCovariance white, lasting;
  double lasts_m = 0.0;  // 0: the bias is independent from picture to picture
};

/// Two models of the motion of one robot: it follows its commands, or it is in contact with a wall or another robot and
/// keeps its velocity in any direction. Each model has a filter and a probability (interacting multiple models: Blom
/// and Bar-Shalom 1988). Units and parameters as in DriveFilter.
class RobotMotion {
 public:
  void start(const Pose& pose, const DriveFilter::Velocity& velocity, double position_sigma_m,
             double heading_sigma_rad);
  /// Starts at the first sighting of the robot.
  void start(const Pose& pose, const DriveFilter::Velocity& velocity, const SightingNoise& noise);
  /// Decorrelates the lasting errors by the motion to the sighted pose. Call it once for each sighting with a heading,
  /// before innovation() and update().
  void renew_lasting_error(const Pose& sighted, const SightingNoise& noise);
  void predict(double dt_s, const DriveInput& input, const RobotFilterParameters& parameters);
  /// Predicts only the state; the covariance is unchanged. A contact becomes less probable with time.
  void predict_state(double dt_s, const DriveInput& input, const RobotFilterParameters& parameters);
  void disturb(double dt_s, const RobotFilterParameters& parameters);
  void scale_covariance(double factor);
  void shift_to(FieldPoint position);

  /// Compares a sighted pose with the prediction. `noise`: covariance without the lasting errors.
  [[nodiscard]] DriveFilter::Innovation innovation(const Pose& sighted, const PoseCovariance& noise) const;
  /// Updates the filters and the probabilities of the models, and mixes the models for the next prediction.
  void update(const Pose& sighted, const PoseCovariance& noise, const RobotFilterParameters& parameters);
  [[nodiscard]] double distance2(FieldPoint patch, const RobotFilterParameters& parameters) const;
  void update(FieldPoint patch, const RobotFilterParameters& parameters);

  /// Returns the probability that the robot is in contact.
  [[nodiscard]] double contact() const { return contact_probability_; }
  /// Returns mean and covariance of the mixture of both models.
  [[nodiscard]] DriveFilter both() const { return free_.mixed(contact_, contact_probability_); }
  [[nodiscard]] Pose pose() const { return DriveFilter::pose_of(state()); }
  [[nodiscard]] Twist twist() const { return DriveFilter::twist_of(state()); }
  [[nodiscard]] double sigma(std::size_t i) const;
  [[nodiscard]] double xy_covariance() const;

  /// See Pipeline::visit_state().
  template <class Self, class Archive>
  static void visit_state(Self& self, Archive& archive) {
    auto& [free, contact, contact_probability, unmixed_s, lasting, lasting_since, same_position, same_heading] = self;
    archive(free, contact, contact_probability, unmixed_s, lasting, lasting_since, same_position, same_heading);
  }

 private:
  [[nodiscard]] DriveFilter::State state() const { return free_.mixed_state(contact_, contact_probability_); }

  DriveFilter free_, contact_;
  double contact_probability_ = 0.0;
  double unmixed_s_ = 0.0;  // time predicted since the last update
  // The lasting errors: their covariance, the pose since which they decorrelate, and the correlations that are left.
  PoseCovariance lasting_;
  Pose lasting_since_;
  double same_position_ = 1.0, same_heading_ = 1.0;
};

}  // namespace touchline
