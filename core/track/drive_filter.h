#pragma once

#include <array>

#include "core/track/command_history.h"
#include "core/track/track_parameters.h"
#include "core/types.h"

namespace touchline {

/// Extended Kalman filter of one robot with a differential drive, Klancar eq. (4)-(9). The paper's state (x, y,
/// heading) is extended by the linear and the angular velocity. Both follow the commanded velocities with the time
/// constant of the wheels; a time constant of zero gives the paper's filter. Without known commands, the velocities are
/// constant except for noise.
///
/// A robot slides if it turns faster than its tires can follow, or if it was pushed. Friction of constant size then
/// acts against the motion of the tires over the floor until they grip. Only a sliding robot has a velocity to the
/// side.
///
/// A sighting has two errors: white noise, and a bias that lasts while the robot stands (the lasting error). The filter
/// does not estimate the bias, but keeps its covariance with the state ("consider" filter, Schmidt 1966). The mean of
/// many sightings of a standing robot therefore keeps the bias in its stated error.
class DriveFilter {
 public:
  // x (m), y (m), heading (rad, in (-pi, pi]), v (m/s), w (rad/s), velocity to the left (m/s; 0 while the tires grip).
  static constexpr std::size_t kStates = 6;
  using State = std::array<double, kStates>;
  using Covariance = std::array<double, kStates * kStates>;  // row-major
  // Covariance of the state's errors with the lasting errors of a sighted x, y and heading; row-major.
  using LastingCovariance = std::array<double, kStates * 3>;

  struct Velocity {
    double v_mps = 0.0, w_radps = 0.0, v_sigma_mps = 0.0, w_sigma_radps = 0.0;
  };

  /// Starts at the first sighting. `noise` and `lasting`: covariances of the sighting's two errors.
  void start(const Pose& pose, const Velocity& velocity, const PoseCovariance& noise, const PoseCovariance& lasting);
  void start(const Pose& pose, const Velocity& velocity, double position_sigma_m, double heading_sigma_rad);
  /// Keeps this share (0 to 1) of the lasting error; an independent new error replaces the rest.
  void renew_lasting_error(double position_part, double heading_part);
  /// Predicts with eq. (5) and the model of eq. (8), linearized at the middle of the step, eq. (9). dt_s >= 0; long
  /// times are divided into steps.
  void predict(double dt_s, const DriveInput& input, const RobotFilterParameters& parameters);
  /// Predicts only the state; the covariance is unchanged.
  void predict_state(double dt_s, const DriveInput& input, const RobotFilterParameters& parameters);

  /// Predicts a robot in contact with a wall or another robot: it keeps its velocity, which may have any direction,
  /// except for noise.
  void predict_contact(double dt_s, const RobotFilterParameters& parameters);
  void predict_contact_state(double dt_s, const RobotFilterParameters& parameters);

  /// Returns the mixture of this distribution and `other`, which has the probability `weight`, with its mean and
  /// covariance.
  [[nodiscard]] DriveFilter mixed(const DriveFilter& other, double weight) const;
  /// Return only the mixture's mean, and only entry (i, k) of its covariance.
  [[nodiscard]] State mixed_state(const DriveFilter& other, double weight) const;
  [[nodiscard]] double mixed_covariance(const DriveFilter& other, double weight, std::size_t i, std::size_t k) const;

  /// Adds the uncertainty of an impact at an unknown instant during the last dt_s seconds. The impact changed the
  /// velocities in any direction.
  void disturb(double dt_s, const RobotFilterParameters& parameters);

  /// Multiplies the covariance by `factor` > 0.
  void scale_covariance(double factor);

  /// Changes only the position.
  void shift_to(FieldPoint position);

  /// Returns the squared Mahalanobis distance of a sighted pose from the prediction (chi-square with 3 degrees of
  /// freedom). `noise` and `lasting`: covariances of the sighting's errors; `noise` is positive definite.
  [[nodiscard]] double distance2(const Pose& sighted, const PoseCovariance& noise,
                                 const PoseCovariance& lasting = {}) const;
  /// Comparison of a sighted pose with a prediction.
  struct Innovation {
    double distance2 = 0.0;  // as distance2()
    // Share of the variance of the innovation that is not noise of the sighting, 0 to 1.
    double predicted_share = 0.0;
    // Innovations of the position along the heading, and of the heading, in standard deviations.
    double along = 0.0, heading = 0.0;
  };
  /// Compares the sighted pose with the mixture that mixed() returns.
  [[nodiscard]] Innovation mixed_innovation(const DriveFilter& other, double weight, const Pose& sighted,
                                            const PoseCovariance& noise, const PoseCovariance& lasting) const;
  /// Updates the state with eq. (6); the heading's innovation is wrapped. Returns the log likelihood of the sighted
  /// pose, without the constant term.
  double update(const Pose& sighted, const PoseCovariance& noise, const PoseCovariance& lasting = {});

  /// Returns the squared Mahalanobis distance of the team patch of a robot whose heading was not seen (2 degrees of
  /// freedom).
  [[nodiscard]] double distance2(FieldPoint patch, const RobotFilterParameters& parameters) const;
  /// Updates the state with the position of a team patch. The patch's offset from the robot's center is unknown but
  /// constant, so it is a bias: many sightings contain no more information than one. The position's variance therefore
  /// never falls below patch_sigma_m^2, and nothing changes if it is already smaller.
  void update(FieldPoint patch, const RobotFilterParameters& parameters);

  [[nodiscard]] const State& state() const { return x_; }
  [[nodiscard]] const Covariance& covariance() const { return p_; }
  [[nodiscard]] static Pose pose_of(const State& x);
  [[nodiscard]] static Twist twist_of(const State& x) { return {static_cast<float>(x[3]), static_cast<float>(x[4])}; }
  [[nodiscard]] Pose pose() const { return pose_of(x_); }
  [[nodiscard]] bool slides() const { return slides_; }
  [[nodiscard]] Twist twist() const { return twist_of(x_); }
  /// Returns the standard deviation of state i.
  [[nodiscard]] double sigma(std::size_t i) const;
  /// Returns the covariance of x and y.
  [[nodiscard]] double xy_covariance() const { return p_[1]; }

  /// See Pipeline::visit_state().
  template <class Self, class Archive>
  static void visit_state(Self& self, Archive& archive) {
    auto& [slides, wheel_mps, x, p, with_lasting] = self;
    archive(slides, wheel_mps, x, p, with_lasting);
  }

 private:
  enum class Extent { kState, kAll };
  void predict(double dt_s, const DriveInput& input, const RobotFilterParameters& parameters, Extent extent);
  void step(double dt_s, const DriveInput& input, const RobotFilterParameters& parameters, Extent extent);
  // Friction between tires and floor, and noise of the velocity along each axis.
  struct Sliding {
    double grip_mps2, noise_mps_rts;
  };
  void slide(double dt_s, const DriveInput& input, const Sliding& sliding, const RobotFilterParameters& parameters,
             Extent extent);
  [[nodiscard]] bool exceeds_grip(double dt_s, const DriveInput& input, const RobotFilterParameters& parameters) const;

  bool slides_ = false;
  double wheel_mps_ = 0.0;  // mean speed of the rims, which follows the command even while the robot slides
  State x_{};
  Covariance p_{};
  LastingCovariance with_lasting_{};
};

}  // namespace touchline
