#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "core/geometry/camera_model.h"
#include "core/marker/marker_layout.h"
#include "tools/programs/evaluate/records.h"

// The Cramer-Rao bound: the smallest possible error of a robot's pose, given the noise of the pictures.
namespace touchline::evaluate {

/// Mean and noise of pictures of a stationary scene. Memory: 48 bytes per pixel, and 3 per pixel of each picture.
class StaticPictures {
 public:
  StaticPictures(std::size_t width_px, std::size_t height_px);

  /// Adds a picture. `rgb`: R, G, B interleaved, rows without padding, 3 * width * height values.
  void add(std::vector<std::uint8_t> rgb);
  [[nodiscard]] std::size_t count() const { return pictures_.size(); }
  /// Estimates the noise. Call once after the last add().
  ///
  /// The variance of each channel is estimated as a function of its mean value, pooled over all pixels of a similar
  /// value, because twelve pictures give the variance of a single pixel only to 40 %. It is at least the variance of
  /// rounding, 1/12.
  ///
  /// Behind a Bayer pattern, two thirds of the values are interpolated from the others and carry no information. They
  /// have less noise, which reveals the pixels where each color was measured; only those values are used.
  ///
  /// The noise of the values used may still be correlated, for example after JPEG, or where pixels share chroma.
  /// Because edges are long, the spectral density of the noise at low frequencies matters: the sum of its correlations
  /// with the neighbors.
  void estimate_noise();
  /// Returns true if a Bayer pattern was found.
  [[nodiscard]] bool is_bayer() const { return step_ == 2; }
  /// Ratio of this spectral density to that of independent noise, averaged over the channels.
  [[nodiscard]] double correlation() const { return density_.trace() / 3.0; }

  /// Fisher information (1 / px^2) about a small shift of the image content within `radius_px` of a point: the sum of g
  /// g' / variance over all values, where g is the gradient of the mean picture. The noise left in the mean is
  /// subtracted from the squared gradient.
  ///
  /// A difference between values at the distance h underestimates the steepness of the edge: the information of an edge
  /// with a Gaussian blur of variance s^2 is proportional to (s^2 + h^2 / 12)^(-1/2). Two distances, h and 2 h, are
  /// therefore extrapolated to h = 0.
  struct FisherInformation {
    double uu = 0.0, uv = 0.0, vv = 0.0;
  };
  [[nodiscard]] FisherInformation fisher_information(Vector2 center_px, double radius_px) const;

 private:
  static constexpr std::size_t kLevels = 32, kReach = 2;
  using Channels = Eigen::Matrix3d;

  [[nodiscard]] double mean(std::size_t u, std::size_t v, std::size_t channel) const {
    return mean_[(v * width_ + u) * 3 + channel];
  }
  [[nodiscard]] static std::size_t level_of(double value) {
    return static_cast<std::size_t>(value * static_cast<double>(kLevels) / 256.0);
  }
  [[nodiscard]] bool is_measured(std::size_t u, std::size_t v, std::size_t channel) const {
    return measured_[channel][2 * (v % 2) + u % 2];
  }
  [[nodiscard]] double deviation(std::size_t u, std::size_t v, std::size_t channel) const;
  void find_bayer_pattern();
  void estimate_variance();
  void estimate_correlation();
  // Mean product of the noise of two pixels at this offset, relative to the standard deviations.
  [[nodiscard]] Channels correlation_at(std::ptrdiff_t du, std::ptrdiff_t dv) const;
  [[nodiscard]] FisherInformation information_at(Vector2 center_px, double radius_px, std::size_t distance) const;

  std::size_t width_, height_, step_ = 1;  // step: distance between values of the same color
  std::vector<std::vector<std::uint8_t>> pictures_;
  std::vector<double> mean_, squares_;  // Welford's algorithm
  std::array<std::array<double, kLevels>, 3> variance_{};
  std::array<std::array<bool, 4>, 3> measured_{};  // by the pixel's position in a square of 2 x 2
  Channels density_ = Channels::Identity();
  // Correlation of the noise of a pixel with its neighbors at one and two steps, along u and v.
  std::array<std::array<Channels, 2>, kReach> neighbors_{};
};

/// Smallest standard deviations that an unbiased estimator can have for one stationary robot, and the measured ones.
struct PoseBound {
  std::string name;
  double center_px = 0.0;                            // bound of the patch centers, RMS over the patches
  double position_m = 0.0, angle_rad = 0.0;          // bound of the pose
  double position_rms_m = 0.0, angle_rms_rad = 0.0;  // measured standard deviations of the sightings, divisor N - 1
};

/// Camera model, marker layouts and names of both teams.
struct BoundInputs {
  CameraModel camera;
  std::array<MarkerLayout, 2> layouts;
  std::array<std::string, 2> teams;  // names of the teams in the results
};

/// Reads the pictures of the results from `folder` and computes the bound of each robot that has an id, a heading and
/// all of its patches in every result. kOutOfRange: there are fewer than three results. kNotFound: there is no such
/// robot. kInconsistent: a picture has another size or more than 8 bits. Other codes: a picture cannot be read.
Result<std::vector<PoseBound>> cramer_rao_bounds(const std::vector<FrameRecord>& results, const std::string& folder,
                                                 const BoundInputs& inputs);

/// Prints a table in pixels, millimeters and degrees, with the ratio of measured value to bound.
void print(const std::vector<PoseBound>& bounds, std::ostream& out);

/// Returns `json` with a list "bound" added, in pixels, meters and radians.
std::string with_bounds(const std::string& json, const std::vector<PoseBound>& bounds);

}  // namespace touchline::evaluate
