#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "core/geometry/angle.h"
#include "core/track/drive_filter.h"
#include "core/track/drive_matrices.h"

// Prediction of DriveFilter: how a robot moves.
namespace touchline {

namespace {

// Longest step: one frame at 25 Hz. Over a longer time (lost frames), one midpoint of a fast turn is too inaccurate.
constexpr double kMaxStep = 0.04;

// Longest step of a sliding robot. The direction of friction changes quickly when the robot comes to a stop.
constexpr double kSlideStep = 0.0025;
// Response of a velocity v to its input u over a step: mean = mean_now * v + mean_input * u. `half_*` is the mean over
// the first half of the step, `end_*` the velocity at its end.
struct Response {
  double mean_now, mean_input, half_now, half_input, end_now, end_input;
};

// Exact solution of dv/dt = (u - v) / lag with constant u.
Response follow(double dt, double lag) {
  // Returns the mean over time t of the remaining fraction of the initial difference.
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
  double v, w;          // input velocities
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

void add_motion_without_wheels(drive::MatrixMap p, double dt, const RobotFilterParameters& parameters) {
  const double slip = parameters.slip_m_rts * parameters.slip_m_rts * dt;
  p(0, 0) += slip;
  p(1, 1) += slip;
  p(2, 2) += parameters.spin_rad_rts * parameters.spin_rad_rts * dt;
}

// Without known commands, the acceleration is white noise within a step, too (Bar-Shalom, Li, Kirubarajan 2001, section
// 6.2.2). An acceleration that is constant over each step would lack this part of the position's variance. A
// displacement that differs by d from the prediction would then change the velocity by 2 d / dt, and the filter would
// alternate around the velocity of a restless robot.
void add_changes_within_step(drive::Matrix& p, double dt, const DriveInput& input, const Eigen::Vector2d& ahead,
                             const RobotFilterParameters& parameters) {
  if (input.known) return;
  const double cube = dt * dt * dt / 12.0, v = parameters.free_noise_mps_rts, w = parameters.free_noise_radps_rts;
  p.topLeftCorner<2, 2>() += v * v * cube * ahead * ahead.transpose();
  p(2, 2) += w * w * cube;
}

// Computes A P A' for the symmetric matrix P. `times_a` multiplies A with a matrix, using only the few entries of A off
// its diagonal.
template <class TimesA>
drive::Matrix propagated(const drive::MatrixMap& p, const TimesA& times_a) {
  drive::Matrix m = p;
  times_a(m);
  m.transposeInPlace();
  times_a(m);
  return m;
}

}  // namespace

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

// Returns true if the tires would need more than their friction at the beginning or the end of a step.
bool DriveFilter::exceeds_grip(double dt, const DriveInput& input, const RobotFilterParameters& parameters) const {
  const InputModel u = input_model(dt, input, x_, parameters);
  const Response& r = u.response;
  const double v = r.end_now * x_[3] + r.end_input * u.v, w = r.end_now * x_[4] + r.end_input * u.w;
  const double along = (v - x_[3]) / dt;
  return std::max(std::hypot(x_[3] * x_[4], along), std::hypot(v * w, along)) > parameters.tire_grip_mps2;
}

// Coulomb friction between tires and floor. Its deceleration has a constant size and points from the robot's velocity
// to the velocity of the wheels. If both can become equal within the step, they do.
void DriveFilter::slide(double dt, const DriveInput& input, const Sliding& sliding,
                        const RobotFilterParameters& parameters, Extent extent) {
  // Limit an absurd velocity (from a wrong sighting), which friction would stop too slowly.
  if (const double speed = std::hypot(x_[3], x_[5]); speed > parameters.max_speed_mps) {
    x_[3] *= parameters.max_speed_mps / speed;
    x_[5] *= parameters.max_speed_mps / speed;
  }
  const InputModel in = input_model(dt, input, x_, parameters);
  const Response& r = in.response;
  const double turned = dt * (r.mean_now * x_[4] + r.mean_input * in.w);
  const double c = std::cos(turned), s = std::sin(turned);
  // Velocity in the robot's frame at the end of the step.
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
    // Linearizes the turn and then the friction, whose direction changes with the velocity.
    Eigen::Matrix<double, 2, 3> by_velocity;  // derivatives of v and u with respect to v, u and w
    by_velocity << c, s, by_w * u, -s, c, -by_w * v;
    if (slides_ && share > 0.0) {
      const Eigen::Vector2d direction(missing_v / missing, missing_u / missing);
      const Eigen::Matrix2d across = Eigen::Matrix2d::Identity() - direction * direction.transpose();
      by_velocity = ((Eigen::Matrix2d::Identity() - share * across) * by_velocity).eval();
    } else if (!slides_) {
      by_velocity.row(1).setZero();
    }
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
    drive::MatrixMap p(p_.data());
    p = propagated(p, times_a);
    drive::LastingMap with_lasting(with_lasting_.data());
    times_a(with_lasting);
    const double slide = sliding.noise_mps_rts * sliding.noise_mps_rts * dt;
    p(3, 3) += slide;
    if (slides_) p(5, 5) += slide;
    p(4, 4) += in.w_var * r.end_input * r.end_input;
    add_motion_without_wheels(p, dt, parameters);
    drive::symmetrize(p);
  }
  x_ = {x_[0] + dx, x_[1] + dy, wrap_angle(theta_end), v_end, r.end_now * x_[4] + r.end_input * in.w, u_end};
}

void DriveFilter::step(double dt, const DriveInput& input, const RobotFilterParameters& parameters, Extent extent) {
  const InputModel u = input_model(dt, input, x_, parameters);
  const Response& r = u.response;
  const double v = r.mean_now * x_[3] + r.mean_input * u.v;
  const double w = r.mean_now * x_[4] + r.mean_input * u.w;
  // Eq. (8) uses the heading at the middle of the step.
  const double half_w = r.half_now * x_[4] + r.half_input * u.w;
  const double middle = x_[2] + 0.5 * dt * half_w;
  const double c = std::cos(middle), s = std::sin(middle);

  if (extent == Extent::kAll) {
    // Eq. (9), extended by the velocities:
    const double turn_now = 0.5 * dt * dt * r.half_now * v, turn_input = 0.5 * dt * dt * r.half_input * v;
    const auto times_a = [&](auto& m) {
      m.row(0) += -dt * v * s * m.row(2) + dt * r.mean_now * c * m.row(3) - turn_now * s * m.row(4);
      m.row(1) += dt * v * c * m.row(2) + dt * r.mean_now * s * m.row(3) + turn_now * c * m.row(4);
      m.row(2) += dt * r.mean_now * m.row(4);
      m.row(3) *= r.end_now;
      m.row(4) *= r.end_now;
    };
    drive::MatrixMap p(p_.data());
    drive::Matrix m = propagated(p, times_a);
    const drive::Vector by_v(dt * r.mean_input * c, dt * r.mean_input * s, 0.0, r.end_input, 0.0, 0.0);
    const drive::Vector by_w(-turn_input * s, turn_input * c, dt * r.mean_input, 0.0, r.end_input, 0.0);
    m += u.v_var * by_v * by_v.transpose() + u.w_var * by_w * by_w.transpose();
    add_changes_within_step(m, dt, input, {c, s}, parameters);
    m.row(5).setZero();
    m.col(5).setZero();
    p = m;
    add_motion_without_wheels(p, dt, parameters);
    drive::symmetrize(p);
    drive::LastingMap with_lasting(with_lasting_.data());
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

// A velocity that changes by d at a uniformly distributed time in the step moves the state by d dt / 2 on average. Its
// variances are those of white noise acceleration with the density d^2 / dt. Its covariance of position and velocity
// would be half larger than the one used here. An unexpected displacement would then change the velocity by half too
// much, and a robot that stopped at the beginning of the step would seem to drive back. The displacement is therefore
// taken as the change of velocity itself, and the variances leave open how much the velocity changed in addition.
void DriveFilter::disturb(double dt, const RobotFilterParameters& parameters) {
  const double push = parameters.impact_mps * parameters.impact_mps;
  const double turn = parameters.impact_radps * parameters.impact_radps;
  const double c = std::cos(x_[2]), s = std::sin(x_[2]);
  drive::MatrixMap p(p_.data());
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
  add_between(0, 3, push * dt / 3.0 * c);
  add_between(1, 3, push * dt / 3.0 * s);
  add_between(2, 4, turn * dt / 3.0);
  add_between(0, 5, -push * dt / 3.0 * s);
  add_between(1, 5, push * dt / 3.0 * c);
}

}  // namespace touchline
