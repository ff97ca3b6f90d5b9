#pragma once

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

/// Mean and noise of pictures of a stationary scene. Memory: 48 bytes per pixel.
class StaticPictures {
 public:
  StaticPictures(std::size_t width_px, std::size_t height_px);

  /// Adds a picture. `rgb`: R, G, B interleaved, rows without padding, 3 * width * height values.
  void add(const std::vector<std::uint8_t>& rgb);
  [[nodiscard]] std::size_t count() const { return count_; }
  /// Estimates the variance of each channel as a function of its mean value, pooled over all pixels of a similar value:
  /// from twelve pictures, the variance of a single pixel is known only to 40 %. The result is at least the variance of
  /// rounding, 1/12. Call once after the last add().
  void estimate_noise();

  /// Fisher information (1 / px^2) about a small shift of the image content within `radius_px` of a point: the sum over
  /// pixels and channels of g g' / variance, where g is the gradient of the mean picture. The noise that remains in the
  /// mean is subtracted from the squared gradient. Noise is assumed to be independent between pixels. Cameras that
  /// interpolate colors violate this, and the true bound is somewhat higher.
  struct FisherInformation {
    double uu = 0.0, uv = 0.0, vv = 0.0;
  };
  [[nodiscard]] FisherInformation fisher_information(Vector2 center_px, double radius_px) const;

 private:
  static constexpr std::size_t kLevels = 32;
  [[nodiscard]] double mean(std::size_t u, std::size_t v, std::size_t channel) const {
    return mean_[(v * width_ + u) * 3 + channel];
  }
  [[nodiscard]] static std::size_t level_of(double value) {
    return static_cast<std::size_t>(value * static_cast<double>(kLevels) / 256.0);
  }

  std::size_t width_, height_, count_ = 0;
  std::vector<double> mean_, squares_;  // Welford's algorithm
  std::array<std::array<double, kLevels>, 3> variance_{};
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
