#include "core/identification/drive_estimator.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "core/geometry/angle.h"
#include "core/geometry/vector2.h"
#include "core/identification/positive_definite.h"

namespace touchline {
namespace {

// Intervals without which nothing is computed: two seconds of a camera with 30 pictures per second.
constexpr std::size_t kMinIntervals = 60;
// Residuals beyond this number of standard deviations get less weight, and none beyond the second one: a robot that was
// pushed, or another robot's sighting. Beyond the third one, they do not count for the variances.
constexpr double kHuber = 2.0, kRejected = 8.0, kClipped = 4.0, kUnclipped = 1e9;
// Passes from the start of the search until the residuals tell the noise.
constexpr std::size_t kRoughPasses = 4;
// Intervals without which the noise is not estimated: five seconds at 60 pictures per second.
constexpr std::size_t kMinForNoise = 300;
// Standard deviations from which a value is used.
constexpr double kKnownDelay_s = 0.0015, kKnownLag_s = 0.005, kKnownGain = 0.005, kKnownDeadZone_mps = 0.005,
                 kKnownLength_m = 0.001;
// The step of the search at 0.5 m/s is 1 cm, which is much more than the error of a sighting; a finer search would find
// the same minimum.
constexpr double kCoarseDelayStep_s = 0.02;
constexpr std::size_t kCoarseDelays = 13;
constexpr std::array<double, 4> kCoarseLags_s{0.02, 0.05, 0.1, 0.2};
constexpr std::size_t kCoarsePoints = kCoarseDelays * kCoarseLags_s.size();
// The search needs no more intervals than these: ten seconds at 60 pictures per second.
constexpr std::size_t kMaxSearched = 600;
// A wheel's effect counts as seen beyond this number of standard deviations.
constexpr double kSeenSigmas = 6.0;

constexpr int kN = static_cast<int>(DriveEstimator::kParameters);
using EigenVector = Eigen::Matrix<double, kN, 1>;
using EigenMatrix = Eigen::Matrix<double, kN, kN, Eigen::RowMajor>;
using VectorMap = Eigen::Map<EigenVector>;
using ConstVectorMap = Eigen::Map<const EigenVector>;
using MatrixMap = Eigen::Map<EigenMatrix>;
using ConstMatrixMap = Eigen::Map<const EigenMatrix>;

// Limits of delay, lags, gains, dead zone, wheel base and marker's place: no robot is outside. The largest step keeps
// the linearization valid.
struct Limit {
  double low, high, step;
};
constexpr std::array<Limit, kN> kLimits{{{0.0, 0.5, 0.02},
                                         {0.002, 1.0, 0.03},
                                         {0.002, 1.0, 0.03},
                                         {0.05, 20.0, 0.3},
                                         {0.05, 20.0, 0.3},
                                         {-0.02, 0.5, 0.03},
                                         {0.01, 1.0, 0.02},
                                         {-0.1, 0.1, 0.005}}};

}  // namespace

void DriveEstimator::restart(const DriveExpectation& expected) {
  prior_ = {expected.delay_s, expected.lag_s, expected.lag_s, 1.0, 1.0, 0.0, expected.wheel_base_m, 0.0};
  prior_sigma_ = {expected.delay_sigma_s,      expected.lag_sigma_s,   expected.lag_sigma_s,
                  expected.gain_sigma,         expected.gain_sigma,    expected.dead_zone_sigma_mps,
                  expected.wheel_base_sigma_m, expected.marker_sigma_m};
  record_.clear();
  begin_search();
}

void DriveEstimator::begin_search() {
  parameters_ = prior_;
  estimate_ = {};
  noise_ = {};
  is_searching_ = true;
  is_reading_ = false;
  coarse_point_ = 0;
  best_cost_ = std::numeric_limits<double>::infinity();
  passes_ = 0;
}

void DriveEstimator::begin_at(const DriveEstimate& other) {
  if (!is_searching_) return;
  begin_search();
  is_searching_ = false;
  wiring_ = estimate_.wiring = other.wiring;
  estimate_.is_wiring_known = other.is_wiring_known;
  parameters_[kDelay] = other.delay_s.value;
  parameters_[kLagLeft] = parameters_[kLagRight] = other.lag_s.value;
}

bool DriveEstimator::work_coarse(std::size_t& intervals) {
  while (coarse_point_ < kCoarsePoints) {
    const double delay = kCoarseDelayStep_s * static_cast<double>(coarse_point_ % kCoarseDelays);
    const double lag = kCoarseLags_s[coarse_point_ / kCoarseDelays];
    if (!is_reading_) {
      reader_ = DriveIntervals(record_, delay, {{{lag, 0.0}, {lag, 0.0}}}, {});
      coarse_ = {};
      is_reading_ = true;
    }
    DriveInterval interval;
    while (coarse_.count < kMaxSearched) {
      if (intervals == 0) return false;
      if (!reader_.next(record_, interval)) break;
      --intervals;
      if (!interval.is_usable) continue;
      const double left = interval.wheels[0].distance_m, right = interval.wheels[1].distance_m;
      const std::array<double, kSeries> seen{interval.forward_m, interval.turn_rad};
      coarse_.ll += left * left;
      coarse_.lr += left * right;
      coarse_.rr += right * right;
      for (std::size_t s = 0; s < kSeries; ++s) {
        coarse_.l[s] += left * seen[s];
        coarse_.r[s] += right * seen[s];
        coarse_.square[s] += seen[s] * seen[s];
      }
      ++coarse_.count;
    }
    is_reading_ = false;
    if (coarse_.count < kMinIntervals) {
      coarse_point_ = 0;
      best_cost_ = std::numeric_limits<double>::infinity();
      return false;
    }
    finish_coarse_point();
    ++coarse_point_;
  }
  return true;
}

// Solves the linear regression of one point of the search.
void DriveEstimator::finish_coarse_point() {
  const double determinant = coarse_.ll * coarse_.rr - coarse_.lr * coarse_.lr;
  if (!(determinant > 1e-6 * coarse_.ll * coarse_.rr)) return;  // the wheels always drove alike
  std::array<double, kSeries> left{}, right{}, rest{};
  for (std::size_t s = 0; s < kSeries; ++s) {
    left[s] = (coarse_.rr * coarse_.l[s] - coarse_.lr * coarse_.r[s]) / determinant;
    right[s] = (coarse_.ll * coarse_.r[s] - coarse_.lr * coarse_.l[s]) / determinant;
    rest[s] = std::max(coarse_.square[s] - left[s] * coarse_.l[s] - right[s] * coarse_.r[s], 1e-12);
  }
  const double count = static_cast<double>(coarse_.count);
  // Log likelihood of both series with unknown variances.
  const double cost = count * (std::log(rest[kForward]) + std::log(rest[kTurn]));
  if (cost >= best_cost_) return;
  best_cost_ = cost;
  const auto sign_of = [&](double slope, double other_square, std::size_t s) {
    const double sigma = std::sqrt(rest[s] / count * other_square / determinant);
    return std::abs(slope) < kSeenSigmas * sigma ? 0.0 : std::copysign(1.0, slope);
  };
  const double left_forward = sign_of(left[kForward], coarse_.rr, kForward);
  const double right_forward = sign_of(right[kForward], coarse_.ll, kForward);
  const double left_turn = sign_of(left[kTurn], coarse_.rr, kTurn),
               right_turn = sign_of(right[kTurn], coarse_.ll, kTurn);
  // A wheel that drives the robot forward and turns it to the left is on its right.
  const double left_side = left_forward * left_turn, right_side = right_forward * right_turn;
  estimate_.is_wiring_known = left_side * right_side < 0.0;
  wiring_ = {left_side > 0.0, {left_forward < 0.0, right_forward < 0.0}};
  parameters_ = prior_;
  parameters_[kDelay] = kCoarseDelayStep_s * static_cast<double>(coarse_point_ % kCoarseDelays);
  parameters_[kLagLeft] = parameters_[kLagRight] = kCoarseLags_s[coarse_point_ / kCoarseDelays];
  parameters_[kGainLeft] = std::abs(wiring_.is_swapped ? right[kForward] : left[kForward]) * 2.0;
  parameters_[kGainRight] = std::abs(wiring_.is_swapped ? left[kForward] : right[kForward]) * 2.0;
  const double turns = std::abs(left[kTurn]) + std::abs(right[kTurn]);
  if (turns > 0.0) parameters_[kBase] = (parameters_[kGainLeft] + parameters_[kGainRight]) / turns;
  for (std::size_t i = 0; i < kParameters; ++i)
    parameters_[i] = std::clamp(parameters_[i], kLimits[i].low, kLimits[i].high);
}

bool DriveEstimator::work(std::size_t& intervals) {
  if (is_searching_) {
    std::size_t searched = intervals * kSearchedPerInterval;
    const bool is_found = work_coarse(searched);
    intervals = searched / kSearchedPerInterval;
    if (!is_found) return false;
    estimate_.wiring = wiring_;
    if (!estimate_.is_wiring_known) {
      begin_search();
      return true;
    }
    is_searching_ = false;
  }
  if (!is_reading_) begin_pass();
  DriveInterval interval;
  for (; intervals > 0; --intervals) {
    if (!reader_.next(record_, interval)) {
      finish_pass();
      return true;
    }
    if (!interval.is_usable) continue;
    add(interval);
  }
  return false;
}

void DriveEstimator::begin_pass() {
  const double dead_zone = parameters_[kDeadZone];
  reader_ = DriveIntervals(record_, parameters_[kDelay],
                           {{{parameters_[kLagLeft], dead_zone}, {parameters_[kLagRight], dead_zone}}}, wiring_);
  sums_ = {};
  noise_estimator_ = NoiseEstimator(noise_, passes_ > kRoughPasses ? kClipped : kUnclipped);
  score_number_ = 0;
  is_reading_ = true;
}

// The model's displacement and turn: (gl l + gr r) / 2 minus the marker's way around the middle between the wheels, and
// (gr r - gl l) / base. Residuals, and the derivatives of the model.
ResidualFilter::Columns DriveEstimator::residuals_of(const DriveInterval& interval) const {
  const auto [left, right] = interval.wheels;
  const double gl = parameters_[kGainLeft], gr = parameters_[kGainRight], per_base = 1.0 / parameters_[kBase];
  const double marker = parameters_[kMarker];
  // The chord of an arc is shorter than the arc.
  const double chord = 1.0 - interval.turn_rad * interval.turn_rad / 24.0;
  const double angle = per_base * (gr * right.distance_m - gl * left.distance_m);
  const double way = chord * (0.5 * (gl * left.distance_m + gr * right.distance_m) - marker * angle);
  const std::array<double, kParameters> turn{per_base * (gr * right.by_delay - gl * left.by_delay),
                                             -per_base * gl * left.by_lag,
                                             per_base * gr * right.by_lag,
                                             -per_base * left.distance_m,
                                             per_base * right.distance_m,
                                             per_base * (gr * right.by_dead_zone - gl * left.by_dead_zone),
                                             -per_base * angle,
                                             0.0};
  const std::array<double, kParameters> mean{0.5 * (gl * left.by_delay + gr * right.by_delay),
                                             0.5 * gl * left.by_lag,
                                             0.5 * gr * right.by_lag,
                                             0.5 * left.distance_m,
                                             0.5 * right.distance_m,
                                             0.5 * (gl * left.by_dead_zone + gr * right.by_dead_zone),
                                             0.0,
                                             0.0};
  ResidualFilter::Columns out;
  out[kForward][0] = interval.forward_m - way;
  out[kTurn][0] = interval.turn_rad - angle;
  for (std::size_t i = 0; i < kParameters; ++i) {
    out[kForward][i + 1] = chord * (mean[i] - marker * turn[i]);
    out[kTurn][i + 1] = turn[i];
  }
  out[kForward][kMarker + 1] = -chord * angle;
  return out;
}

void DriveEstimator::add(const DriveInterval& interval) {
  ModeledMotion motion;
  motion.dt_s = interval.dt_s;
  motion.lag_s = 0.5 * (parameters_[kLagLeft] + parameters_[kLagRight]);
  motion.wheel_base_m = parameters_[kBase];
  for (std::size_t i = 0; i < 2; ++i) {
    const double gain = parameters_[i == 0 ? kGainLeft : kGainRight];
    motion.travel_m[i] = gain * interval.wheels[i].distance_m;
    motion.late_travel_mps[i] = gain * interval.late_travel_mps[i];
    motion.late_speed_mps2[i] = gain * interval.late_speed_mps2[i];
  }
  ResidualFilter::Columns columns = residuals_of(interval);
  if (!interval.continues) filter_.restart(noise_);
  noise_estimator_.add(motion, {columns[kForward][0], columns[kTurn][0]}, interval.continues);
  filter_.whiten(motion, columns);
  Vector score{};
  MatrixMap information(sums_.information.data());
  for (const Series series : {kForward, kTurn}) {
    const double sigmas = std::abs(columns[series][0]);
    double weight = 1.0;
    if (passes_ > kRoughPasses && sigmas > kHuber) weight = sigmas > kRejected ? 0.0 : kHuber / sigmas;
    const ConstVectorMap gradient(columns[series].data() + 1);
    information += weight * gradient * gradient.transpose();
    VectorMap(score.data()) += weight * columns[series][0] * gradient;
  }
  const ConstVectorMap now(score.data());
  VectorMap(sums_.score.data()) += now;
  ++sums_.count;
  // Newey and West (1987), with Bartlett's weights.
  MatrixMap scatter(sums_.scatter.data());
  scatter += now * now.transpose();
  for (std::size_t distance = 1; distance <= std::min(kCorrelated, score_number_); ++distance) {
    const ConstVectorMap before(scores_[(score_number_ - distance) % kCorrelated].data());
    const double weight = 1.0 - static_cast<double>(distance) / static_cast<double>(kCorrelated + 1);
    scatter += weight * (now * before.transpose() + before * now.transpose());
  }
  scores_[score_number_++ % kCorrelated] = score;
}

void DriveEstimator::finish_pass() {
  is_reading_ = false;
  if (sums_.count < kMinIntervals) return begin_search();
  Matrix information = sums_.information;
  EigenVector score = ConstVectorMap(sums_.score.data());
  EigenMatrix scatter = ConstMatrixMap(sums_.scatter.data());
  for (std::size_t i = 0; i < kParameters; ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    const double weight = 1.0 / (prior_sigma_[i] * prior_sigma_[i]);
    information[i * kParameters + i] += weight;
    scatter(at, at) += weight;
    score(at) += weight * (prior_[i] - parameters_[i]);
  }
  const Matrix inverted = inverse_of<kParameters>(information);
  const ConstMatrixMap inverse(inverted.data());
  const EigenVector step = inverse.lazyProduct(score);
  // Lazy products, because the others contain calls of malloc for matrices of this size.
  const EigenMatrix half = inverse.lazyProduct(scatter);
  EigenMatrix covariance = half.lazyProduct(inverse);
  // Few data can show a small scatter by chance; the model's own covariance is the lower limit.
  const EigenVector widening =
      (inverse.diagonal().array() / covariance.diagonal().array().max(1e-300)).max(1.0).sqrt().matrix();
  covariance = (widening.asDiagonal() * covariance * widening.asDiagonal()).eval();
  MatrixMap(covariance_.data()) = covariance;
  moved_ = 0.0;
  for (std::size_t i = 0; i < kParameters; ++i) {
    const Limit& limit = kLimits[i];
    const double wanted = step(static_cast<Eigen::Index>(i));
    parameters_[i] = std::clamp(parameters_[i] + std::clamp(wanted, -limit.step, limit.step), limit.low, limit.high);
    // Not the limited step: a value that a limit holds is not settled.
    moved_ = std::max(moved_, std::abs(wanted) / std::sqrt(std::max(covariance_[i * kParameters + i], 1e-30)));
  }
  // Far from the solution, a wrong delay looks like lateness of the packets, whose weight would keep it wrong.
  if (passes_ >= kRoughPasses && sums_.count >= kMinForNoise) noise_ = noise_estimator_.estimate();
  ++passes_;
  report(sums_.count);
}

void DriveEstimator::report(std::size_t count) {
  // The noise is estimated twice.
  constexpr std::size_t kMinPasses = kRoughPasses + 2;
  const bool is_settled = estimate_.is_settled = passes_ >= kMinPasses && moved_ < 1.0;
  const auto set = [&](MeasuredValue& out, Index i, double sigma_needed) {
    const double variance = covariance_[i * kParameters + i];
    out.value = parameters_[i];
    out.sigma = passes_ >= kMinPasses ? std::sqrt(variance) : std::numeric_limits<double>::infinity();
    out.is_known = is_settled && out.sigma <= sigma_needed;
  };
  set(estimate_.delay_s, kDelay, kKnownDelay_s);
  set(estimate_.lag_left_s, kLagLeft, kKnownLag_s);
  set(estimate_.lag_right_s, kLagRight, kKnownLag_s);
  // The mean is better known than each of them, because their errors are opposite.
  MeasuredValue& lag = estimate_.lag_s;
  lag = estimate_.lag_left_s;
  lag.value = 0.5 * (parameters_[kLagLeft] + parameters_[kLagRight]);
  if (std::isfinite(lag.sigma)) {
    const double both =
        covariance_[kLagLeft * kParameters + kLagLeft] + covariance_[kLagRight * kParameters + kLagRight];
    lag.sigma = 0.5 * std::sqrt(std::max(0.0, both + 2.0 * covariance_[kLagLeft * kParameters + kLagRight]));
  }
  lag.is_known = is_settled && lag.sigma <= kKnownLag_s;
  set(estimate_.gain_left, kGainLeft, kKnownGain);
  set(estimate_.gain_right, kGainRight, kKnownGain);
  set(estimate_.dead_zone_mps, kDeadZone, kKnownDeadZone_mps);
  set(estimate_.wheel_base_m, kBase, kKnownLength_m);
  set(estimate_.marker_left_m, kMarker, kKnownLength_m);
  estimate_.intervals = count;
}

Pose DriveEstimator::pose_after_commands(Instant now) const {
  if (record_.sightings_end() == 0) return {};
  const DriveRecord::Sighting& last = record_.sighting(record_.sightings_end() - 1);
  // A command shows completely after delay and lag.
  const double late = parameters_[kDelay] + 0.5 * (parameters_[kLagLeft] + parameters_[kLagRight]);
  const Instant obeyed = last.captured - from_seconds(late);
  Vector2 place = position(last.pose);
  double angle = heading(last.pose);
  std::uint64_t number = record_.commands_end();
  while (number > record_.commands_begin() && record_.command(number - 1).sent > obeyed) --number;
  if (number > record_.commands_begin()) --number;
  for (; number < record_.commands_end(); ++number) {
    const DriveRecord::Command& command = record_.command(number);
    const Instant end = number + 1 < record_.commands_end() ? record_.command(number + 1).sent : now;
    const double dt = std::max(0.0, seconds(end - std::max(command.sent, obeyed)));
    const WheelSpeeds wheels = wiring_.wheels_of(command.wheels);
    const double left = parameters_[kGainLeft] * static_cast<double>(wheels.left_mps);
    const double right = parameters_[kGainRight] * static_cast<double>(wheels.right_mps);
    const double turn = dt * (right - left) / parameters_[kBase];
    place = place + 0.5 * dt * (left + right) * unit_vector(angle + 0.5 * turn);
    angle += turn;
  }
  return {to_field_point(place), wrap_to_float(angle)};
}

void DriveEstimator::solve() {
  // From the coarse search, twelve passes suffice; without convergence the values stay unknown.
  constexpr int kMaxPasses = 20;
  constexpr double kConverged = 0.02;
  // From values that a short record gave, the steps can end at a wrong delay with a large noise.
  begin_search();
  for (int i = 0; i < kMaxPasses; ++i) {
    std::size_t intervals = std::numeric_limits<std::size_t>::max() / kSearchedPerInterval;
    if (!work(intervals) || is_searching_) return;
    if (passes_ > kRoughPasses + 2 && moved_ < kConverged) return;
  }
}

}  // namespace touchline
