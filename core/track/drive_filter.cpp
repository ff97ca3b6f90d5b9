#include "core/track/drive_filter.h"

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "core/geometry/angle.h"
#include "core/track/drive_matrices.h"

namespace touchline {

namespace {

// If the velocity to the side is smaller, the tires grip within a slide step.
constexpr double kMinSlide_mps = 0.02;

Eigen::Matrix3d matrix_of(const PoseCovariance& noise) {
  Eigen::Matrix3f m;
  m << noise.xx, noise.xy, noise.xt, noise.xy, noise.yy, noise.yt, noise.xt, noise.yt, noise.tt;
  return m.cast<double>();
}

Eigen::Vector3d pose_innovation(const Pose& sighted, const DriveFilter::State& x) {
  return {static_cast<double>(sighted.position.x_m) - x[0], static_cast<double>(sighted.position.y_m) - x[1],
          wrap_angle(static_cast<double>(sighted.theta_rad) - x[2])};
}

Eigen::Vector2d position_innovation(FieldPoint sighted, const DriveFilter::State& x) {
  return {static_cast<double>(sighted.x_m) - x[0], static_cast<double>(sighted.y_m) - x[1]};
}

// Returns the covariance of the innovation of a sighted pose. `with_lasting`: covariance of the predicted pose with the
// lasting error.
Eigen::Matrix3d innovation_covariance(const Eigen::Matrix3d& state, const Eigen::Matrix3d& with_lasting,
                                      const PoseCovariance& noise, const PoseCovariance& lasting) {
  return state + with_lasting + with_lasting.transpose() + matrix_of(noise) + matrix_of(lasting);
}

double from_to(const DriveFilter::State& a, const DriveFilter::State& b, std::size_t i) {
  return i == 2 ? wrap_angle(b[i] - a[i]) : b[i] - a[i];
}

}  // namespace

void DriveFilter::start(const Pose& pose, const Velocity& velocity, double position_sigma_m, double heading_sigma_rad) {
  x_ = {static_cast<double>(pose.position.x_m),
        static_cast<double>(pose.position.y_m),
        wrap_angle(static_cast<double>(pose.theta_rad)),
        velocity.v_mps,
        velocity.w_radps,
        0.0};
  const State sigma = {position_sigma_m,     position_sigma_m,       heading_sigma_rad,
                       velocity.v_sigma_mps, velocity.w_sigma_radps, 0.0};
  slides_ = false;
  wheel_mps_ = velocity.v_mps;
  p_.fill(0.0);
  with_lasting_.fill(0.0);
  for (std::size_t i = 0; i < kStates; ++i) p_[i * kStates + i] = sigma[i] * sigma[i];
}

void DriveFilter::start(const Pose& pose, const Velocity& velocity, const PoseCovariance& noise,
                        const PoseCovariance& lasting) {
  start(pose, velocity, 0.0, 0.0);
  drive::MatrixMap(p_.data()).topLeftCorner<3, 3>() = matrix_of(noise) + matrix_of(lasting);
  drive::LastingMap(with_lasting_.data()).topRows<3>() = -matrix_of(lasting);
}

void DriveFilter::renew_lasting_error(double position_part, double heading_part) {
  drive::LastingMap with_lasting(with_lasting_.data());
  with_lasting.leftCols<2>() *= position_part;
  with_lasting.col(2) *= heading_part;
}

DriveFilter DriveFilter::mixed(const DriveFilter& other, double weight) const {
  DriveFilter out = *this;
  State apart;
  for (std::size_t i = 0; i < kStates; ++i) {
    apart[i] = from_to(x_, other.x_, i);
    out.x_[i] += weight * apart[i];
  }
  out.x_[2] = wrap_angle(out.x_[2]);
  const double spread = weight * (1.0 - weight);
  for (std::size_t i = 0; i < kStates; ++i) {
    for (std::size_t k = 0; k <= i; ++k) {
      const std::size_t at = i * kStates + k;
      out.p_[at] = out.p_[k * kStates + i] = p_[at] + weight * (other.p_[at] - p_[at]) + spread * apart[i] * apart[k];
    }
  }
  for (std::size_t i = 0; i < with_lasting_.size(); ++i)
    out.with_lasting_[i] += weight * (other.with_lasting_[i] - with_lasting_[i]);
  out.slides_ = out.slides_ || std::abs(out.x_[5]) > kMinSlide_mps;
  return out;
}

DriveFilter::State DriveFilter::mixed_state(const DriveFilter& other, double weight) const {
  State mean = x_;
  for (std::size_t i = 0; i < kStates; ++i) mean[i] += weight * from_to(x_, other.x_, i);
  mean[2] = wrap_angle(mean[2]);
  return mean;
}

double DriveFilter::mixed_covariance(const DriveFilter& other, double weight, std::size_t i, std::size_t k) const {
  const std::size_t at = i * kStates + k;
  return (1.0 - weight) * p_[at] + weight * other.p_[at] +
         weight * (1.0 - weight) * from_to(x_, other.x_, i) * from_to(x_, other.x_, k);
}

void DriveFilter::scale_covariance(double factor) { drive::MatrixMap(p_.data()) *= factor; }

void DriveFilter::shift_to(FieldPoint position) {
  x_[0] = static_cast<double>(position.x_m);
  x_[1] = static_cast<double>(position.y_m);
}

double DriveFilter::distance2(const Pose& sighted, const PoseCovariance& noise, const PoseCovariance& lasting) const {
  const Eigen::Vector3d innovation = pose_innovation(sighted, x_);
  const Eigen::Matrix3d s =
      innovation_covariance(drive::ConstMatrixMap(p_.data()).topLeftCorner<3, 3>(),
                            drive::ConstLastingMap(with_lasting_.data()).topRows<3>(), noise, lasting);
  return innovation.dot(s.inverse() * innovation);
}

DriveFilter::Innovation DriveFilter::mixed_innovation(const DriveFilter& other, double weight, const Pose& sighted,
                                                      const PoseCovariance& noise,
                                                      const PoseCovariance& lasting) const {
  const Eigen::Vector3d innovation = pose_innovation(sighted, x_);
  const Eigen::Vector3d apart(from_to(x_, other.x_, 0), from_to(x_, other.x_, 1), from_to(x_, other.x_, 2));
  const auto mean = [weight](const auto& a, const auto& b) -> Eigen::Matrix3d { return a + weight * (b - a); };
  const Eigen::Matrix3d state = mean(drive::ConstMatrixMap(p_.data()).topLeftCorner<3, 3>(),
                                     drive::ConstMatrixMap(other.p_.data()).topLeftCorner<3, 3>()) +
                                weight * (1.0 - weight) * apart * apart.transpose();
  const Eigen::Matrix3d with_lasting = mean(drive::ConstLastingMap(with_lasting_.data()).topRows<3>(),
                                            drive::ConstLastingMap(other.with_lasting_.data()).topRows<3>());
  const Eigen::Matrix3d s = innovation_covariance(state, with_lasting, noise, lasting);
  Eigen::Vector3d from_mean = innovation - weight * apart;
  from_mean(2) = wrap_angle(from_mean(2));
  const Eigen::Matrix3d inverse = s.inverse();
  const Eigen::Matrix3d white = matrix_of(noise);
  const double theta = x_[2] + weight * apart(2);
  const Eigen::Vector3d ahead(std::cos(theta), std::sin(theta), 0.0);
  return {from_mean.dot(inverse * from_mean), 1.0 - inverse.cwiseProduct(white).sum() / 3.0,
          ahead.dot(from_mean) / std::sqrt(ahead.dot(s * ahead)), from_mean(2) / std::sqrt(s(2, 2))};
}

double DriveFilter::update(const Pose& sighted, const PoseCovariance& noise, const PoseCovariance& lasting) {
  drive::VectorMap x(x_.data());
  drive::MatrixMap p(p_.data());
  drive::LastingMap with_lasting(with_lasting_.data());
  const Eigen::Vector3d innovation = pose_innovation(sighted, x_);
  const Eigen::Matrix3d s = innovation_covariance(p.topLeftCorner<3, 3>(), with_lasting.topRows<3>(), noise, lasting);
  const Eigen::Matrix3d inverse = s.inverse();
  const drive::LastingMatrix with_innovation = p.leftCols<3>() + with_lasting;
  const drive::LastingMatrix gain = with_innovation * inverse;
  x += gain * innovation;
  x(2) = wrap_angle(x(2));
  // Eq. (6) in Joseph form, which keeps the covariance positive despite rounding: with A = I - K H,
  // P <- A P A' - (A C K' + K C' A') + K (N + B) K' and C <- A C - K B, where C is with_lasting, N the noise and B the
  // covariance of the lasting error.
  const drive::LastingMatrix rest = with_lasting - gain * with_lasting.topRows<3>();
  const drive::Matrix left = p - gain * p.topRows<3>();
  const drive::LastingMatrix half = 0.5 * gain * (matrix_of(noise) + matrix_of(lasting)) - rest;
  const drive::Matrix added = half * gain.transpose();
  p = left - left.leftCols<3>() * gain.transpose() + added + added.transpose();
  drive::symmetrize(p);
  with_lasting = rest - gain * matrix_of(lasting);
  slides_ = slides_ || std::abs(x_[5]) > kMinSlide_mps;
  if (!slides_) wheel_mps_ = x_[3];
  return -0.5 * (innovation.dot(inverse * innovation) + std::log(s.determinant()));
}

double DriveFilter::distance2(FieldPoint patch, const RobotFilterParameters& parameters) const {
  const Eigen::Vector2d innovation = position_innovation(patch, x_);
  const double variance = parameters.patch_sigma_m * parameters.patch_sigma_m;
  const Eigen::Matrix2d s =
      drive::ConstMatrixMap(p_.data()).topLeftCorner<2, 2>() + Eigen::Matrix2d(variance * Eigen::Matrix2d::Identity());
  return innovation.dot(s.inverse() * innovation);
}

void DriveFilter::update(FieldPoint patch, const RobotFilterParameters& parameters) {
  const double known = 0.5 * (p_[0] + p_[kStates + 1]);
  const double best = parameters.patch_sigma_m * parameters.patch_sigma_m;
  if (known <= best) return;
  // Returns the measurement noise with which eq. (6) reduces a variance from `known` to `best`.
  const double variance = known * best / (known - best);
  drive::VectorMap x(x_.data());
  drive::MatrixMap p(p_.data());
  drive::LastingMap with_lasting(with_lasting_.data());
  const Eigen::Matrix2d s = p.topLeftCorner<2, 2>() + Eigen::Matrix2d(variance * Eigen::Matrix2d::Identity());
  const Eigen::Matrix<double, drive::kN, 2> with_innovation = p.leftCols<2>();
  const Eigen::Matrix<double, drive::kN, 2> gain = with_innovation * s.inverse();
  x += gain * position_innovation(patch, x_);
  x(2) = wrap_angle(x(2));
  const drive::Matrix left = p - gain * p.topRows<2>();
  p = left - left.leftCols<2>() * gain.transpose() + variance * gain * gain.transpose();
  drive::symmetrize(p);
  with_lasting -= (gain * with_lasting.topRows<2>()).eval();
}

Pose DriveFilter::pose_of(const State& x) {
  return {{static_cast<float>(x[0]), static_cast<float>(x[1])}, wrap_to_float(x[2])};
}

double DriveFilter::sigma(std::size_t i) const { return std::sqrt(std::max(0.0, p_[i * kStates + i])); }

}  // namespace touchline
