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
  /// The variance of each channel is a function of its mean value, pooled over all pixels of a similar value: from
  /// twelve pictures, the variance of a single pixel is known only to 40 %. It is at least that of rounding, 1/12.
  ///
  /// Behind a Bayer pattern, two thirds of the values are interpolated from the others and say nothing new. They have
  /// less noise, which tells where each color was measured; then only the measured values count.
  ///
  /// The noise of values that count may still be correlated, as after JPEG, or where pixels share chroma. Edges are
  /// long, so the spectral density of the noise at low frequencies counts: the sum of its correlations with the
  /// neighbors.
  void estimate_noise();
  /// True if a Bayer pattern was found.
  [[nodiscard]] bool is_bayer() const { return step_ == 2; }
  /// Ratio of this spectral density to that of independent noise, mean of the channels.
  [[nodiscard]] double correlation() const { return density_.trace() / 3.0; }

  /// Fisher information (1 / px^2) about a small shift of the image content within `radius_px` of a point: the sum over
  /// values of g g' / variance, where g is the gradient of the mean picture. The noise that remains in the mean is
  /// subtracted from the squared gradient.
  ///
  /// A difference between values at the distance h is less steep than the edge between them: the information of an edge
  /// with a Gaussian blur of the variance s^2 is proportional to (s^2 + h^2 / 12)^(-1/2). Two distances, h and 2 h,
  /// give that of h = 0.
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
  // Mean product of the noise at pixels this far apart, relative to the standard deviations.
  [[nodiscard]] Channels correlation_at(std::ptrdiff_t du, std::ptrdiff_t dv) const;
  [[nodiscard]] FisherInformation information_at(Vector2 center_px, double radius_px, std::size_t distance) const;

  std::size_t width_, height_, step_ = 1;  // step: distance of values of one color
  std::vector<std::vector<std::uint8_t>> pictures_;
  std::vector<double> mean_, squares_;  // Welford's algorithm
  std::array<std::array<double, kLevels>, 3> variance_{};
  std::array<std::array<bool, 4>, 3> measured_{};  // by the pixel's place in a square of 2 x 2
  Channels density_ = Channels::Identity();
  // Of noise between a pixel and its neighbors at the distance of one and two steps, along u and v.
  std::array<std::array<Channels, 2>, kReach> neighbors_{};
};

/// Smallest standard deviations of any unbiased estimator for one stationary robot, and the measured ones.
struct PoseBound {
  std::string name;
  double center_px = 0.0;                            // bound of the patch centers, RMS over the patches
  double position_m = 0.0, angle_rad = 0.0;          // bound of the pose
  double position_rms_m = 0.0, angle_rms_rad = 0.0;  // measured, of the sightings about their mean, divisor N - 1
};

/// Camera model, marker layouts and names of both teams.
struct BoundInputs {
  CameraModel camera;
  std::array<MarkerLayout, 2> layouts;
  std::array<std::string, 2> teams;  // names in the results
};

/// Reads the pictures of the results from `folder` and computes the bound of each robot that has an id, a heading and
/// all of its patches in every result. kOutOfRange: fewer than three results. kNotFound: no such robot. kInconsistent:
/// a picture has another size or more than 8 bits. Other codes: a picture cannot be read.
Result<std::vector<PoseBound>> cramer_rao_bounds(const std::vector<FrameRecord>& results, const std::string& folder,
                                                 const BoundInputs& inputs);

/// Prints a table in pixels, millimeters and degrees, with the ratio of measured value to bound.
void print(const std::vector<PoseBound>& bounds, std::ostream& out);

/// Returns `json` with a list "bound" added, in pixels, meters and radians.
std::string with_bounds(const std::string& json, const std::vector<PoseBound>& bounds);

}  // namespace touchline::evaluate
