#pragma once

#include <array>
#include <cstddef>
#include <limits>

#include "core/identification/drive_intervals.h"
#include "core/identification/drive_record.h"
#include "core/identification/residual_filter.h"
#include "core/types.h"

namespace touchline {

/// What DriveEstimator measures of a robot.
struct DriveEstimate {
  MeasuredValue delay_s;  // from the last byte of a packet to the wheels
  MeasuredValue lag_s;    // time constant of the wheels, mean of both
  MeasuredValue lag_left_s, lag_right_s;
  MeasuredValue gain_left, gain_right;  // speed of a wheel's rim per commanded speed beyond the dead zone
  MeasuredValue dead_zone_mps;          // part of a command that moves nothing
  MeasuredValue wheel_base_m;
  MeasuredValue marker_left_m;  // how far the marker's center is to the left of the middle between the wheels
  WheelWiring wiring;
  bool is_wiring_known = false;
  // The passes no longer ask for changes of the values by more than their standard deviations, also at the limits that
  // hold the values.
  bool is_settled = false;
  std::size_t intervals = 0;  // that were used
};

/// What is known before the measurement. The defaults are as wide as robots of the leagues are different.
struct DriveExpectation {
  double delay_s = 0.06, delay_sigma_s = 0.1;
  double lag_s = 0.08, lag_sigma_s = 0.1;
  double gain_sigma = 0.5;  // around 1
  double dead_zone_sigma_mps = 0.05;
  double wheel_base_m = 0.07, wheel_base_sigma_m = 0.02;
  double marker_sigma_m = 0.003;
};

/// Measures delay, lag, gains and geometry of a robot's drive from its commands and sightings.
///
/// Model: each wheel follows its command, reduced by the dead zone, after the delay like a first-order lag. The robot's
/// displacement and turn between two sightings follow from the wheels' travels (odometry with the heading at the
/// middle). A coarse search over delay and lag finds the wiring and the start; then each pass over the record is one
/// step of Gauss and Newton, with a weak prior.
///
/// Uncertainty: a Kalman filter for slip and errors of sightings whitens the residuals (residual_filter.h). Those
/// beyond 2 standard deviations get less weight (Huber). The covariance is the one of Newey and West (1987) for the
/// correlation that remains.
///
/// Nothing is allocated. The computation can be divided: work() processes a part of a pass.
class DriveEstimator {
 public:
  static constexpr std::size_t kParameters = 8;
  using Vector = std::array<double, kParameters>;

  DriveEstimator() : DriveEstimator(DriveExpectation()) {}
  explicit DriveEstimator(const DriveExpectation& expected) { restart(expected); }
  /// Forgets record and estimate.
  void restart(const DriveExpectation& expected);
  /// Begins at the delay, the lag and the wiring of another robot of the same kind instead of searching for them. Has
  /// no effect after the search.
  void begin_at(const DriveEstimate& other);

  /// Wheel speeds that hold until the next ones. `sent`: when the last byte of the packet left. Returns false, and adds
  /// nothing, if they are not newer than the last ones, or not finite.
  [[nodiscard]] bool add_command(Instant sent, const WheelSpeeds& wheels) { return record_.add_command(sent, wheels); }
  void add_sighting(Instant captured, const Pose& pose) { record_.add_sighting(captured, pose); }

  /// Something else than the wheels may move the robot until the next sighting.
  void add_break() { record_.add_break(); }

  /// Processes at most this number of intervals, or kSearchedPerInterval times as many during the search, and reduces
  /// it by what was processed. Returns true if it completed a pass that changed the estimate. Returns false with
  /// intervals left if the record is too short.
  bool work(std::size_t& intervals);
  // An interval of the search takes 0.25 us, one of a pass 2 us.
  static constexpr std::size_t kSearchedPerInterval = 8;
  /// Works until the estimate does not change any more. For use off line: takes some milliseconds per second of record.
  void solve();

  [[nodiscard]] const DriveEstimate& estimate() const { return estimate_; }
  /// Where the robot will be when it has obeyed all commands until `now`, by the values known so far. For a short time:
  /// sum of the commands' displacements. Returns the origin without a sighting.
  [[nodiscard]] Pose pose_after_commands(Instant now) const;
  [[nodiscard]] const DriveRecord& record() const { return record_; }

 private:
  static_assert(ResidualFilter::kColumns == kParameters + 1);
  enum Index : std::size_t { kDelay, kLagLeft, kLagRight, kGainLeft, kGainRight, kDeadZone, kBase, kMarker };
  // The two series of residuals.
  enum Series : std::size_t { kForward, kTurn, kSeries };
  // Distance up to which correlations between whitened residuals count.
  static constexpr std::size_t kCorrelated = 12;
  using Matrix = std::array<double, kParameters * kParameters>;

  // Sums of the coarse search, for one delay and lag: displacement and turn as linear functions of the travels that the
  // two commands ask for.
  struct CoarseSums {
    double ll = 0.0, lr = 0.0, rr = 0.0;
    std::array<double, kSeries> l{}, r{}, square{};
    std::size_t count = 0;
  };
  struct PassSums {
    Matrix information{}, scatter{};
    Vector score{};
    std::size_t count = 0;
  };

  bool work_coarse(std::size_t& intervals);
  void finish_coarse_point();
  void begin_search();
  void begin_pass();
  void add(const DriveInterval& interval);
  [[nodiscard]] ResidualFilter::Columns residuals_of(const DriveInterval& interval) const;
  void finish_pass();
  void report(std::size_t count);

  DriveRecord record_;
  Vector prior_{}, prior_sigma_{}, parameters_{};
  DriveEstimate estimate_;
  Matrix covariance_{};  // of the parameters, row-major
  double moved_ = 0.0;   // step that the last pass asked for, in standard deviations

  // Search
  bool is_searching_ = true, is_reading_ = false;
  std::size_t coarse_point_ = 0;
  CoarseSums coarse_;
  double best_cost_ = 0.0;
  WheelWiring wiring_;
  std::size_t passes_ = 0;

  // Pass
  DriveIntervals reader_;
  PassSums sums_;
  DriveNoise noise_;
  NoiseEstimator noise_estimator_;
  ResidualFilter filter_;
  std::array<Vector, kCorrelated> scores_{};
  std::size_t score_number_ = 0;
};

}  // namespace touchline
