#include "core/track/drive_filter.h"

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "core/geometry/angle.h"

namespace touchline {
namespace {

constexpr int kN = static_cast<int>(DriveFilter::kStates);
using Vector = Eigen::Matrix<double, kN, 1>;
using Matrix = Eigen::Matrix<double, kN, kN, Eigen::RowMajor>;
using VectorMap = Eigen::Map<Vector>;
using MatrixMap = Eigen::Map<Matrix>;
using ConstMatrixMap = Eigen::Map<const Matrix>;
using LastingMatrix = Eigen::Matrix<double, kN, 3, Eigen::RowMajor>;
using LastingMap = Eigen::Map<LastingMatrix>;
using ConstLastingMap = Eigen::Map<const LastingMatrix>;

// One frame at 25 Hz. For longer times (lost frames) one midpoint of a fast turn is too inaccurate.
constexpr double kMaxStep = 0.04;

// Friction turns quickly when a sliding robot comes to a stop.
constexpr double kSlideStep = 0.0025;
// Slower than this to the side, the tires grip within a slide step.
constexpr double kLeastSlide_mps = 0.02;

// Response of a velocity v to its input u over a step: mean = mean_now * v + mean_input * u. `half_*` is the mean over
// the first half of the step, `end_*` the velocity at its end.
struct Response {
  double mean_now, mean_input, half_now, half_input, end_now, end_input;
};

// Exact solution of dv/dt = (u - v) / lag with constant u.
Response follow(double dt, double lag) {
  // Mean over time t of the remaining fraction of the initial difference.
  const auto average = [lag](double t) { return lag / t * -std::expm1(-t / lag); };
  const double mean = lag > 0.0 ? average(dt) : 0.0;
  const double half = lag > 0.0 ? average(0.5 * dt) : 0.0;
  const double end = lag > 0.0 ? std::exp(-dt / lag) : 0.0;
  return {mean, 1.0 - mean, half, 1.0 - half, end, 1.0 - end};
}

// dv/dt = u, where u is an acceleration with mean zero.
Response coast(double dt) { return {1.0, 0.5 * dt, 1.0, 0.25 * dt, 1.0, dt}; }

struct InputModel {
  Response response;
  double v, w;          // input
  double v_var, w_var;  // variance of the input over the step: V of eq. (5)
};

InputModel input_model(double dt, const DriveInput& input, const DriveFilter::State& x,
                       const RobotFilterParameters& p) {
  const auto square = [](double a) { return a * a; };
  if (!input.known) {
    return {coast(dt), 0.0, 0.0, square(p.free_noise_mps_rts) / dt, square(p.free_noise_radps_rts) / dt};
  }
  const double v = static_cast<double>(input.twist.v_mps), w = static_cast<double>(input.twist.w_radps);
  const double speed = std::max(std::abs(v), std::abs(x[3])), turn = std::max(std::abs(w), std::abs(x[4]));
  return {
      follow(dt, p.wheel_lag_s), v, w, (square(p.drive_noise_m_rts) + square(p.drive_error_rts * speed)) / dt,
      (square(p.turn_noise_rad_rts) + square(p.turn_error_rts * turn) + square(p.veer_error_rts_per_m * speed)) / dt};
}

void add_motion_without_wheels(MatrixMap p, double dt, const RobotFilterParameters& parameters) {
  const double slip = parameters.slip_m_rts * parameters.slip_m_rts * dt;
  p(0, 0) += slip;
  p(1, 1) += slip;
  p(2, 2) += parameters.spin_rad_rts * parameters.spin_rad_rts * dt;
}

void symmetrize(MatrixMap p) {
  for (int i = 0; i < kN; ++i) {
    for (int k = 0; k < i; ++k) p(i, k) = p(k, i) = 0.5 * (p(i, k) + p(k, i));
  }
}

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

// Covariance of the difference between a sighted pose and its prediction. `with_lasting`: covariance of both's errors.
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
  MatrixMap(p_.data()).topLeftCorner<3, 3>() = matrix_of(noise) + matrix_of(lasting);
  LastingMap(with_lasting_.data()).topRows<3>() = -matrix_of(lasting);
}

void DriveFilter::renew_lasting_error(double position_part, double heading_part) {
  LastingMap with_lasting(with_lasting_.data());
  with_lasting.leftCols<2>() *= position_part;
  with_lasting.col(2) *= heading_part;
}

void DriveFilter::predict(double dt_s, const DriveInput& input, const RobotFilterParameters& parameters) {
  predict(dt_s, input, parameters, Extent::kAll);
}

void DriveFilter::predict_state(double dt_s, const DriveInput& input, const RobotFilterParameters& parameters) {
  predict(dt_s, input, parameters, Extent::kState);
}

void DriveFilter::predict(double dt_s, const DriveInput& input, const RobotFilterParameters& parameters,
                          Extent extent) {
  if (!(dt_s > 0.0)) return;
  const int steps = static_cast<int>(std::ceil(dt_s / kMaxStep));
  for (int i = 0; i < steps; ++i) {
    const double dt = dt_s / steps;
    const bool can_slide = parameters.tire_grip_mps2 > 0.0;
    if (!can_slide || (!slides_ && !exceeds_grip(dt, input, parameters))) {
      step(dt, input, parameters, extent);
      continue;
    }
    const int slide_steps = static_cast<int>(std::ceil(dt / kSlideStep));
    for (int k = 0; k < slide_steps; ++k) {
      slide(dt / slide_steps, input, {parameters.tire_grip_mps2, parameters.slide_noise_mps_rts}, parameters, extent);
    }
  }
}

void DriveFilter::predict_contact(double dt_s, const RobotFilterParameters& parameters) {
  if (dt_s > 0.0) slide(dt_s, {}, {0.0, parameters.contact_noise_mps_rts}, parameters, Extent::kAll);
}

void DriveFilter::predict_contact_state(double dt_s, const RobotFilterParameters& parameters) {
  if (dt_s > 0.0) slide(dt_s, {}, {0.0, parameters.contact_noise_mps_rts}, parameters, Extent::kState);
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
  out.slides_ = out.slides_ || std::abs(out.x_[5]) > kLeastSlide_mps;
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

// True if the tires would need more than their friction at the beginning or the end of a step.
bool DriveFilter::exceeds_grip(double dt, const DriveInput& input, const RobotFilterParameters& parameters) const {
  const InputModel u = input_model(dt, input, x_, parameters);
  const Response& r = u.response;
  const double v = r.end_now * x_[3] + r.end_input * u.v, w = r.end_now * x_[4] + r.end_input * u.w;
  const double along = (v - x_[3]) / dt;
  return std::max(std::hypot(x_[3] * x_[4], along), std::hypot(v * w, along)) > parameters.tire_grip_mps2;
}

// Coulomb friction between tires and floor: its deceleration has a constant size and the direction from the robot's
// velocity to that of its wheels, unless it can make both equal within the step.
void DriveFilter::slide(double dt, const DriveInput& input, const Sliding& sliding,
                        const RobotFilterParameters& parameters, Extent extent) {
  // Friction stops an absurd velocity, from a wrong sighting, too slowly.
  if (const double speed = std::hypot(x_[3], x_[5]); speed > parameters.max_speed_mps) {
    x_[3] *= parameters.max_speed_mps / speed;
    x_[5] *= parameters.max_speed_mps / speed;
  }
  const InputModel in = input_model(dt, input, x_, parameters);
  const Response& r = in.response;
  const double turned = dt * (r.mean_now * x_[4] + r.mean_input * in.w);
  const double c = std::cos(turned), s = std::sin(turned);
  // The velocity in the frame of the robot at the end of the step.
  const double v = c * x_[3] + s * x_[5], u = c * x_[5] - s * x_[3];
  wheel_mps_ = input.known ? r.end_now * wheel_mps_ + r.end_input * in.v : wheel_mps_;
  const double missing_v = wheel_mps_ - v, missing_u = -u, missing = std::hypot(missing_v, missing_u);
  const double friction = sliding.grip_mps2 * dt;
  slides_ = missing > friction || friction == 0.0;
  const double share = !slides_ ? 1.0 : friction > 0.0 ? friction / missing : 0.0;
  const double v_end = v + share * missing_v, u_end = slides_ ? u + share * missing_u : 0.0;

  const double theta = x_[2], theta_end = theta + turned;
  const double dx =
      0.5 * dt *
      (x_[3] * std::cos(theta) - x_[5] * std::sin(theta) + v_end * std::cos(theta_end) - u_end * std::sin(theta_end));
  const double dy =
      0.5 * dt *
      (x_[3] * std::sin(theta) + x_[5] * std::cos(theta) + v_end * std::sin(theta_end) + u_end * std::cos(theta_end));
  if (extent == Extent::kAll) {
    const double middle = theta + 0.5 * turned, by_w = dt * r.mean_now;
    const double ahead_x = dt * std::cos(middle), ahead_y = dt * std::sin(middle);
    // The turn, then friction, which changes its direction with the velocity.
    Eigen::Matrix<double, 2, 3> by_velocity;  // of v and u by v, u and w
    by_velocity << c, s, by_w * u, -s, c, -by_w * v;
    if (slides_ && share > 0.0) {
      const Eigen::Vector2d direction(missing_v / missing, missing_u / missing);
      const Eigen::Matrix2d across = Eigen::Matrix2d::Identity() - direction * direction.transpose();
      by_velocity = ((Eigen::Matrix2d::Identity() - share * across) * by_velocity).eval();
    } else if (!slides_) {
      by_velocity.row(1).setZero();
    }
    // A P A', computed from the few entries of A beside its diagonal.
    const auto times_a = [&](auto& m) {
      m.row(0) += ahead_x * m.row(3) - ahead_y * m.row(5) - dy * m.row(2);
      m.row(1) += ahead_y * m.row(3) + ahead_x * m.row(5) + dx * m.row(2);
      m.row(2) += by_w * m.row(4);
      const auto by = [&](Eigen::Index i) {
        return (by_velocity(i, 0) * m.row(3) + by_velocity(i, 2) * m.row(4) + by_velocity(i, 1) * m.row(5)).eval();
      };
      const auto v_row = by(0), u_row = by(1);
      m.row(3) = v_row;
      m.row(4) *= r.end_now;
      m.row(5) = u_row;
    };
    MatrixMap p(p_.data());
    Matrix m = p;
    times_a(m);
    m.transposeInPlace();
    times_a(m);
    p = m;
    LastingMap with_lasting(with_lasting_.data());
    times_a(with_lasting);
    const double slide = sliding.noise_mps_rts * sliding.noise_mps_rts * dt;
    p(3, 3) += slide;
    if (slides_) p(5, 5) += slide;
    p(4, 4) += in.w_var * r.end_input * r.end_input;
    add_motion_without_wheels(p, dt, parameters);
    symmetrize(p);
  }
  x_ = {x_[0] + dx, x_[1] + dy, wrap_angle(theta_end), v_end, r.end_now * x_[4] + r.end_input * in.w, u_end};
}

void DriveFilter::step(double dt, const DriveInput& input, const RobotFilterParameters& parameters, Extent extent) {
  const InputModel u = input_model(dt, input, x_, parameters);
  const Response& r = u.response;
  const double v = r.mean_now * x_[3] + r.mean_input * u.v;
  const double w = r.mean_now * x_[4] + r.mean_input * u.w;
  // Eq. (8): the heading at the middle of the step.
  const double half_w = r.half_now * x_[4] + r.half_input * u.w;
  const double middle = x_[2] + 0.5 * dt * half_w;
  const double c = std::cos(middle), s = std::sin(middle);

  if (extent == Extent::kAll) {
    // Eq. (9), extended by the velocities: A P A', computed from the few entries of A beside its diagonal.
    const double turn_now = 0.5 * dt * dt * r.half_now * v, turn_input = 0.5 * dt * dt * r.half_input * v;
    const auto times_a = [&](auto& m) {
      m.row(0) += -dt * v * s * m.row(2) + dt * r.mean_now * c * m.row(3) - turn_now * s * m.row(4);
      m.row(1) += dt * v * c * m.row(2) + dt * r.mean_now * s * m.row(3) + turn_now * c * m.row(4);
      m.row(2) += dt * r.mean_now * m.row(4);
      m.row(3) *= r.end_now;
      m.row(4) *= r.end_now;
    };
    MatrixMap p(p_.data());
    Matrix m = p;
    times_a(m);
    m.transposeInPlace();
    times_a(m);
    const Vector by_v(dt * r.mean_input * c, dt * r.mean_input * s, 0.0, r.end_input, 0.0, 0.0);
    const Vector by_w(-turn_input * s, turn_input * c, dt * r.mean_input, 0.0, r.end_input, 0.0);
    m += u.v_var * by_v * by_v.transpose() + u.w_var * by_w * by_w.transpose();
    m.row(5).setZero();
    m.col(5).setZero();
    p = m;
    add_motion_without_wheels(p, dt, parameters);
    symmetrize(p);
    LastingMap with_lasting(with_lasting_.data());
    times_a(with_lasting);
    with_lasting.row(5).setZero();
  }

  x_[0] += dt * v * c;
  x_[1] += dt * v * s;
  x_[2] = wrap_angle(x_[2] + dt * w);
  x_[3] = r.end_now * x_[3] + r.end_input * u.v;
  x_[4] = r.end_now * x_[4] + r.end_input * u.w;
  x_[5] = 0.0;
  slides_ = false;
  wheel_mps_ = x_[3];
}

// A velocity that changes by d at a time that is distributed uniformly over the step moves the state by d dt / 2 on
// average; its variances are those of white noise acceleration with the density d^2 / dt.
void DriveFilter::disturb(double dt, const RobotFilterParameters& parameters) {
  const double push = parameters.impact_mps * parameters.impact_mps;
  const double turn = parameters.impact_radps * parameters.impact_radps;
  const double c = std::cos(x_[2]), s = std::sin(x_[2]);
  MatrixMap p(p_.data());
  p(0, 0) += push * dt * dt / 3.0;
  p(1, 1) += push * dt * dt / 3.0;
  p(2, 2) += turn * dt * dt / 3.0;
  p(3, 3) += push;
  p(4, 4) += turn;
  p(5, 5) += push;
  const auto add_between = [&p](Eigen::Index i, Eigen::Index k, double covariance) {
    p(i, k) += covariance;
    p(k, i) += covariance;
  };
  add_between(0, 3, 0.5 * push * dt * c);
  add_between(1, 3, 0.5 * push * dt * s);
  add_between(2, 4, 0.5 * turn * dt);
  add_between(0, 5, -0.5 * push * dt * s);
  add_between(1, 5, 0.5 * push * dt * c);
}

void DriveFilter::scale_covariance(double factor) { MatrixMap(p_.data()) *= factor; }

void DriveFilter::shift_to(FieldPoint position) {
  x_[0] = static_cast<double>(position.x_m);
  x_[1] = static_cast<double>(position.y_m);
}

double DriveFilter::distance2(const Pose& sighted, const PoseCovariance& noise, const PoseCovariance& lasting) const {
  const Eigen::Vector3d innovation = pose_innovation(sighted, x_);
  const Eigen::Matrix3d s = innovation_covariance(ConstMatrixMap(p_.data()).topLeftCorner<3, 3>(),
                                                  ConstLastingMap(with_lasting_.data()).topRows<3>(), noise, lasting);
  return innovation.dot(s.inverse() * innovation);
}

DriveFilter::Innovation DriveFilter::mixed_innovation(const DriveFilter& other, double weight, const Pose& sighted,
                                                      const PoseCovariance& noise,
                                                      const PoseCovariance& lasting) const {
  const Eigen::Vector3d innovation = pose_innovation(sighted, x_);
  const Eigen::Vector3d apart(from_to(x_, other.x_, 0), from_to(x_, other.x_, 1), from_to(x_, other.x_, 2));
  const auto mean = [weight](const auto& a, const auto& b) -> Eigen::Matrix3d { return a + weight * (b - a); };
  const Eigen::Matrix3d state =
      mean(ConstMatrixMap(p_.data()).topLeftCorner<3, 3>(), ConstMatrixMap(other.p_.data()).topLeftCorner<3, 3>()) +
      weight * (1.0 - weight) * apart * apart.transpose();
  const Eigen::Matrix3d with_lasting = mean(ConstLastingMap(with_lasting_.data()).topRows<3>(),
                                            ConstLastingMap(other.with_lasting_.data()).topRows<3>());
  const Eigen::Matrix3d s = innovation_covariance(state, with_lasting, noise, lasting);
  Eigen::Vector3d from_mean = innovation - weight * apart;
  from_mean(2) = wrap_angle(from_mean(2));
  const Eigen::Matrix3d inverse = s.inverse();
  return {from_mean.dot(inverse * from_mean), 1.0 - inverse.cwiseProduct(matrix_of(noise)).sum() / 3.0};
}

double DriveFilter::update(const Pose& sighted, const PoseCovariance& noise, const PoseCovariance& lasting) {
  VectorMap x(x_.data());
  MatrixMap p(p_.data());
  LastingMap with_lasting(with_lasting_.data());
  const Eigen::Vector3d innovation = pose_innovation(sighted, x_);
  const Eigen::Matrix3d s = innovation_covariance(p.topLeftCorner<3, 3>(), with_lasting.topRows<3>(), noise, lasting);
  const Eigen::Matrix3d inverse = s.inverse();
  const LastingMatrix with_innovation = p.leftCols<3>() + with_lasting;
  const LastingMatrix gain = with_innovation * inverse;
  x += gain * innovation;
  x(2) = wrap_angle(x(2));
  // Eq. (6) in Joseph form, which keeps the covariance positive despite rounding: with A = I - K H,
  // P <- A P A' - (A C K' + K C' A') + K (N + B) K' and C <- A C - K B, where C is with_lasting, N the noise and B the
  // covariance of the lasting error.
  const LastingMatrix rest = with_lasting - gain * with_lasting.topRows<3>();
  const Matrix left = p - gain * p.topRows<3>();
  const LastingMatrix half = 0.5 * gain * (matrix_of(noise) + matrix_of(lasting)) - rest;
  const Matrix added = half * gain.transpose();
  p = left - left.leftCols<3>() * gain.transpose() + added + added.transpose();
  symmetrize(p);
  with_lasting = rest - gain * matrix_of(lasting);
  slides_ = slides_ || std::abs(x_[5]) > kLeastSlide_mps;
  if (!slides_) wheel_mps_ = x_[3];
  return -0.5 * (innovation.dot(inverse * innovation) + std::log(s.determinant()));
}

double DriveFilter::distance2(FieldPoint patch, const RobotFilterParameters& parameters) const {
  const Eigen::Vector2d innovation = position_innovation(patch, x_);
  const double variance = parameters.patch_sigma_m * parameters.patch_sigma_m;
  const Eigen::Matrix2d s =
      ConstMatrixMap(p_.data()).topLeftCorner<2, 2>() + Eigen::Matrix2d(variance * Eigen::Matrix2d::Identity());
  return innovation.dot(s.inverse() * innovation);
}

void DriveFilter::update(FieldPoint patch, const RobotFilterParameters& parameters) {
  const double known = 0.5 * (p_[0] + p_[kStates + 1]);
  const double best = parameters.patch_sigma_m * parameters.patch_sigma_m;
  if (known <= best) return;
  // The measurement noise with which eq. (6) reduces a variance `known` to `best`.
  const double variance = known * best / (known - best);
  VectorMap x(x_.data());
  MatrixMap p(p_.data());
  LastingMap with_lasting(with_lasting_.data());
  const Eigen::Matrix2d s = p.topLeftCorner<2, 2>() + Eigen::Matrix2d(variance * Eigen::Matrix2d::Identity());
  const Eigen::Matrix<double, kN, 2> with_innovation = p.leftCols<2>();
  const Eigen::Matrix<double, kN, 2> gain = with_innovation * s.inverse();
  x += gain * position_innovation(patch, x_);
  x(2) = wrap_angle(x(2));
  const Matrix left = p - gain * p.topRows<2>();
  p = left - left.leftCols<2>() * gain.transpose() + variance * gain * gain.transpose();
  symmetrize(p);
  with_lasting -= (gain * with_lasting.topRows<2>()).eval();
}

Pose DriveFilter::pose_of(const State& x) {
  return {{static_cast<float>(x[0]), static_cast<float>(x[1])}, wrap_to_float(x[2])};
}

double DriveFilter::sigma(std::size_t i) const { return std::sqrt(std::max(0.0, p_[i * kStates + i])); }

}  // namespace touchline
