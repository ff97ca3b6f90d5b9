#pragma once

#include <array>
#include <cstddef>

namespace touchline {

/// The errors that a model of a drive cannot explain.
struct DriveNoise {
  double slip = 0.03;          // standard deviation of the relative error of a wheel's travel
  double slip_lasts_s = 0.05;  // its correlation time
  double forward_sigma_m = 0.0005, turn_sigma_rad = 0.005;  // of a sighting
  double late_sigma_s = 0.003;                              // of the delay from packet to packet
};

/// Motion of the left and the right wheel between two sightings, as the model has it.
struct ModeledMotion {
  using PerWheel = std::array<double, 2>;
  PerWheel travel_m{};
  PerWheel late_travel_mps{}, late_speed_mps2{};       // as in DriveInterval, multiplied by the gains
  double dt_s = 0.0, lag_s = 0.0, wheel_base_m = 0.0;  // lag: mean of both wheels
};

/// Whitens the residuals of successive displacements, and whatever depends on them linearly, with a Kalman filter for
/// their errors: each wheel has a relative slip that lasts for some time, a packet that comes later or earlier than
/// others changes the speed of both wheels until they have followed, and a sighting's error enters two displacements
/// with opposite signs. The filter's innovations are independent if the noise is described correctly.
class ResidualFilter {
 public:
  // A residual and its derivatives by the parameters of the model.
  static constexpr std::size_t kColumns = 9;
  // Displacement forward and turn.
  using Columns = std::array<std::array<double, kColumns>, 2>;

  void restart(const DriveNoise& noise);
  /// Replaces the columns by those of the innovations, in units of their standard deviations.
  void whiten(const ModeledMotion& motion, Columns& columns);

 private:
  // Slip of both wheels; errors of the former and of the new sighting, each forward and turn; errors of both wheels'
  // speeds at the beginning, and lateness of the packet that acts during the interval.
  static constexpr std::size_t kStates = 9;

  DriveNoise noise_;
  std::array<double, kStates * kStates> covariance_{};  // row-major
  std::array<double, kStates * kColumns> states_{};     // row-major; one column for each column of the residuals
};

/// Estimates the noise from the residuals by their squares and the products of successive ones: both are linear in the
/// variances of slip, sightings and lateness.
class NoiseEstimator {
 public:
  /// `noise`: as estimated before, for weights. `clip`: number of standard deviations beyond which a residual counts no
  /// more.
  explicit NoiseEstimator(const DriveNoise& noise = {}, double clip = 1e9) : noise_(noise), clip_(clip) {}
  /// `continues`: the former call belongs to the interval before.
  void add(const ModeledMotion& motion, const std::array<double, 2>& residual, bool continues);
  [[nodiscard]] DriveNoise estimate() const;

 private:
  // Variances: of the slip, the covariance of successive slips, of a sighting's position, of its heading, and of a
  // packet's lateness.
  static constexpr std::size_t kUnknowns = 5;
  using Quadratic = std::array<double, 4>;  // matrix of both wheels, row-major
  void add_equation(const std::array<double, kUnknowns>& factors, double product, double weight);

  DriveNoise noise_;
  double clip_;
  std::array<double, kUnknowns * kUnknowns> normal_{};
  std::array<double, kUnknowns> right_side_{};
  double time_s_ = 0.0, count_ = 0.0;
  ModeledMotion::PerWheel former_travels_{};
  // For a variance of lateness of 1: of the wheels' speeds at the beginning of the interval, and their covariance with
  // the former travels.
  Quadratic speed_{}, speed_with_former_{};
  std::array<double, 2> former_{};
};

}  // namespace touchline
