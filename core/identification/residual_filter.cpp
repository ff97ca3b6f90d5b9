#include "core/identification/residual_filter.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "core/identification/positive_definite.h"

namespace touchline {
namespace {

// The filter needs positive variances.
constexpr double kMinForward_m = 1e-6, kMinTurn_rad = 1e-5;
// No wheel rolls without slip.
constexpr double kMinSlip = 0.005;
// Slip cannot be distinguished from a gain if it lasts longer than the parts of a measurement in which the robot drives
// in one direction.
constexpr double kMinSlipLasts_s = 0.02, kMaxSlipLasts_s = 0.2;

double square(double a) { return a * a; }

// Travel during the interval per speed error at its beginning, which decays with the lag.
double following(const ModeledMotion& motion) { return motion.lag_s * -std::expm1(-motion.dt_s / motion.lag_s); }

}  // namespace

void ResidualFilter::restart(const DriveNoise& noise) {
  noise_ = noise;
  states_ = {};
  covariance_ = {};
  const double slip = square(noise.slip), forward = square(noise.forward_sigma_m), turn = square(noise.turn_sigma_rad);
  const std::array<double, kStates> variance{slip, slip, 0.0, 0.0, forward, turn, 0.0, 0.0, 0.0};
  for (std::size_t i = 0; i < kStates; ++i) covariance_[i * kStates + i] = variance[i];
}

void ResidualFilter::whiten(const ModeledMotion& motion, Columns& columns) {
  constexpr int kS = static_cast<int>(kStates), kC = static_cast<int>(kColumns);
  Eigen::Map<Eigen::Matrix<double, kS, kS, Eigen::RowMajor>> p(covariance_.data());
  Eigen::Map<Eigen::Matrix<double, kS, kC, Eigen::RowMajor>> x(states_.data());
  Eigen::Map<Eigen::Matrix<double, 2, kC, Eigen::RowMajor>> y(columns[0].data());
  // What changes before the interval: the slip decays, the new sighting becomes the former one, and its successor and
  // the next packet are independent.
  const double remains = std::exp(-motion.dt_s / noise_.slip_lasts_s);
  for (Eigen::Index i = 0; i < 2; ++i) {
    x.row(i) *= remains;
    p.row(i) *= remains;
    p.col(i) *= remains;
    p(i, i) += square(noise_.slip) * (1.0 - square(remains));
  }
  const auto renew = [&](Eigen::Index i, double sigma) {
    x.row(i).setZero();
    p.row(i).setZero();
    p.col(i).setZero();
    p(i, i) = square(sigma);
  };
  for (Eigen::Index i = 0; i < 2; ++i) {
    x.row(2 + i) = x.row(4 + i);
    p.row(2 + i) = p.row(4 + i).eval();
    p.col(2 + i) = p.col(4 + i).eval();
    p(2 + i, 2 + i) = p(4 + i, 4 + i);
  }
  renew(4, noise_.forward_sigma_m);
  renew(5, noise_.turn_sigma_rad);
  renew(8, noise_.late_sigma_s);

  const double followed = following(motion), per_base = 1.0 / motion.wheel_base_m;
  const auto &travel = motion.travel_m, &late = motion.late_travel_mps;
  Eigen::Matrix<double, 2, kS> h;
  h << 0.5 * travel[0], 0.5 * travel[1], -1.0, 0.0, 1.0, 0.0, 0.5 * followed, 0.5 * followed, 0.5 * (late[0] + late[1]),
      -travel[0] * per_base, travel[1] * per_base, 0.0, -1.0, 0.0, 1.0, -followed * per_base, followed * per_base,
      (late[1] - late[0]) * per_base;
  // Lazy products, because the others contain calls of malloc for matrices of this size.
  const Eigen::Matrix<double, kS, 2> ph = p.lazyProduct(h.transpose());
  const Eigen::Matrix2d variance = h.lazyProduct(ph);
  const Eigen::Matrix<double, 2, kC> innovation = y - h.lazyProduct(x);
  const double determinant = variance(0, 0) * variance(1, 1) - square(variance(0, 1));
  Eigen::Matrix2d inverse;
  inverse << variance(1, 1), -variance(0, 1), -variance(0, 1), variance(0, 0);
  const Eigen::Matrix<double, kS, 2> gain = ph.lazyProduct(inverse) / determinant;
  x += gain.lazyProduct(innovation);
  p -= gain.lazyProduct(ph.transpose()).eval();
  p = (0.5 * (p + p.transpose())).eval();
  // Innovations in units of their standard deviations: the second one is what the first one does not tell.
  const double first = std::sqrt(variance(0, 0)), second = std::sqrt(determinant) / first;
  y.row(0) = innovation.row(0) / first;
  y.row(1) = (innovation.row(1) - variance(0, 1) / variance(0, 0) * innovation.row(0)) / second;

  // What changes during the interval: the speeds follow, and the packet adds its lateness.
  const double kept = std::exp(-motion.dt_s / motion.lag_s);
  for (Eigen::Index i = 0; i < 2; ++i) {
    const double speed = motion.late_speed_mps2[static_cast<std::size_t>(i)];
    x.row(6 + i) = (kept * x.row(6 + i) + speed * x.row(8)).eval();
    p.row(6 + i) = (kept * p.row(6 + i) + speed * p.row(8)).eval();
    p.col(6 + i) = (kept * p.col(6 + i) + speed * p.col(8)).eval();
  }
}

void NoiseEstimator::add_equation(const std::array<double, kUnknowns>& factors, double product, double weight) {
  for (std::size_t i = 0; i < kUnknowns; ++i) {
    right_side_[i] += weight * factors[i] * product;
    for (std::size_t k = 0; k < kUnknowns; ++k) normal_[i * kUnknowns + k] += weight * factors[i] * factors[k];
  }
}

void NoiseEstimator::add(const ModeledMotion& motion, const std::array<double, 2>& residual, bool continues) {
  if (!continues) speed_ = speed_with_former_ = {};
  time_s_ += motion.dt_s;
  count_ += 1.0;
  const auto &travel = motion.travel_m, &late = motion.late_travel_mps, &jump = motion.late_speed_mps2;
  const double followed = following(motion), kept = std::exp(-motion.dt_s / motion.lag_s);
  // Covariances of the wheels' travels: with themselves and with the former ones.
  Quadratic now{}, successive{};
  for (std::size_t i = 0; i < 2; ++i) {
    for (std::size_t k = 0; k < 2; ++k) {
      now[2 * i + k] = followed * followed * speed_[2 * i + k] + late[i] * late[k];
      successive[2 * i + k] = followed * speed_with_former_[2 * i + k];
    }
  }
  const double travel2 = square(travel[0]) + square(travel[1]);
  const double travels = travel[0] * former_travels_[0] + travel[1] * former_travels_[1];
  const std::array<double, 2> sighting{square(noise_.forward_sigma_m), square(noise_.turn_sigma_rad)};
  // The displacement is (left + right) / 2, and the turn (right - left) / base.
  const std::array<double, 2> share{0.25, 1.0 / square(motion.wheel_base_m)};
  for (std::size_t s = 0; s < 2; ++s) {
    const double sign = s == 0 ? 1.0 : -1.0;
    const auto combined = [&](const Quadratic& q) { return share[s] * (q[0] + q[3] + sign * (q[1] + q[2])); };
    const double variance =
        2.0 * sighting[s] + square(noise_.slip) * share[s] * travel2 + square(noise_.late_sigma_s) * combined(now);
    // A product of residuals has a variance that is proportional to the square of theirs.
    const double weight = 1.0 / square(variance), bound = square(clip_) * variance;
    std::array<double, kUnknowns> factors{share[s] * travel2, 0.0, 0.0, 0.0, combined(now)};
    factors[2 + s] = 2.0;
    add_equation(factors, std::min(square(residual[s]), bound), weight);
    if (!continues) continue;
    factors = {0.0, share[s] * travels, 0.0, 0.0, combined(successive)};
    factors[2 + s] = -1.0;
    add_equation(factors, std::clamp(residual[s] * former_[s], -bound, bound), weight);
  }
  former_ = residual;
  former_travels_ = travel;
  for (std::size_t i = 0; i < 2; ++i) {
    for (std::size_t k = 0; k < 2; ++k) {
      speed_with_former_[2 * i + k] = kept * followed * speed_[2 * i + k] + jump[i] * late[k];
    }
  }
  for (std::size_t i = 0; i < 2; ++i) {
    for (std::size_t k = 0; k < 2; ++k) speed_[2 * i + k] = kept * kept * speed_[2 * i + k] + jump[i] * jump[k];
  }
}

DriveNoise NoiseEstimator::estimate() const {
  std::array<double, kUnknowns* kUnknowns> normal = normal_;
  std::array<double, kUnknowns> right = right_side_;
  // Noisy sightings show neither slip nor lateness, so a value that is usual decides then. A normally distributed
  // residual's square has twice the square of its variance as variance.
  const DriveNoise usual;
  const auto expect = [&](std::size_t i, double value, double sigma) {
    normal[i * kUnknowns + i] += 2.0 / square(sigma);
    right[i] += 2.0 / square(sigma) * value;
  };
  const double slip = square(usual.slip), late = square(usual.late_sigma_s);
  expect(0, slip, slip);
  expect(1, slip * std::exp(-time_s_ / std::max(count_, 1.0) / usual.slip_lasts_s), slip);
  expect(4, late, late);
  // The unknowns have different units, hence the scaling.
  std::array<double, kUnknowns> scale{};
  for (std::size_t i = 0; i < kUnknowns; ++i) scale[i] = 1.0 / std::sqrt(std::max(normal[i * kUnknowns + i], 1e-300));
  for (std::size_t i = 0; i < kUnknowns; ++i) {
    for (std::size_t k = 0; k < kUnknowns; ++k) normal[i * kUnknowns + k] *= scale[i] * scale[k];
    normal[i * kUnknowns + i] += 1e-9;
  }
  const std::array<double, kUnknowns* kUnknowns> inverse = inverse_of<kUnknowns>(normal);
  std::array<double, kUnknowns> found{};
  for (std::size_t i = 0; i < kUnknowns; ++i) {
    for (std::size_t k = 0; k < kUnknowns; ++k) {
      found[i] += scale[i] * inverse[i * kUnknowns + k] * scale[k] * right[k];
    }
  }
  DriveNoise out;
  out.slip = std::sqrt(std::max(found[0], square(kMinSlip)));
  const double correlation = std::clamp(found[1] / square(out.slip), 0.01, 0.99);
  const double lasts = -(time_s_ / std::max(count_, 1.0)) / std::log(correlation);
  out.slip_lasts_s = std::clamp(lasts, kMinSlipLasts_s, kMaxSlipLasts_s);
  out.forward_sigma_m = std::sqrt(std::max(found[2], square(kMinForward_m)));
  out.turn_sigma_rad = std::sqrt(std::max(found[3], square(kMinTurn_rad)));
  out.late_sigma_s = std::sqrt(std::max(found[4], square(1e-5)));
  return out;
}

}  // namespace touchline
