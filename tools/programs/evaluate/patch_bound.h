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

// How well a robot's pose can be known at all from pictures with the noise that these have: the Cramer-Rao bound.
namespace touchline::evaluate {

/// Mean and noise of pictures in which nothing moves. Memory: 48 bytes a pixel.
class StandingPictures {
 public:
  StandingPictures(std::size_t width_px, std::size_t height_px);

  /// `rgb`: R, G, B interleaved, rows without gaps, 3 * width * height values.
  void add(const std::vector<std::uint8_t>& rgb);
  [[nodiscard]] std::size_t count() const { return count_; }
  /// Variance of a channel as a function of its mean value, pooled over all pixels of about that value: twelve pictures
  /// show a pixel's own variance to 40 % only. At least that of rounding, 1/12. Call once after the last add().
  void find_noise();

  /// Fisher information about a small shift of what stands within `radius_px` of a point: the sum over pixels and
  /// channels of g g' / variance, g being the gradient of the mean picture (1 / px^2: uu, uv, vv). The noise that is
  /// left in the mean is subtracted from the squares of the gradient. Noise counts as independent from pixel to pixel;
  /// where a camera interpolates colors it is not, and the true bound is somewhat higher.
  struct Information {
    double uu = 0.0, uv = 0.0, vv = 0.0;
  };
  [[nodiscard]] Information information(Point center_px, double radius_px) const;

 private:
  static constexpr std::size_t kLevels = 32;
  [[nodiscard]] double mean(std::size_t u, std::size_t v, std::size_t channel) const {
    return mean_[(v * width_ + u) * 3 + channel];
  }
  [[nodiscard]] static std::size_t level_of(double value) {
    return static_cast<std::size_t>(value * static_cast<double>(kLevels) / 256.0);
  }

  std::size_t width_, height_, count_ = 0;
  std::vector<double> mean_, squares_;  // Welford's
  std::array<std::array<double, kLevels>, 3> variance_{};
};

/// Of one robot that stands: the least standard deviations that any unbiased estimator can have, and the measured ones.
struct PoseBound {
  std::string name;
  double center_px = 0.0;                            // bound of a patch's center, RMS distance over its patches
  double position_m = 0.0, angle_rad = 0.0;          // bound of the pose
  double position_rms_m = 0.0, angle_rms_rad = 0.0;  // of the sightings about their mean, with N - 1
};

/// What turns pixels into poses.
struct BoundSetting {
  CameraModel camera;
  std::array<MarkerLayout, 2> layouts;
  std::array<std::string, 2> teams;  // what results call them
};

/// Reads the results' pictures from `folder` and gives the bound of each robot that has an id, a heading and all its
/// patches in every result. False, with the reason: fewer than three results, a picture that cannot be read or has
/// another size, no such robot.
bool find_bounds(const std::vector<FrameRecord>& results, const std::string& folder, const BoundSetting& setting,
                 std::vector<PoseBound>& out, std::string& error);

/// Table in pixels, millimeters and degrees, and how many times the bound is measured.
void print(const std::vector<PoseBound>& bounds, std::ostream& out);

/// `json` with a list "bound" added: pixels, meters, radians.
std::string with_bounds(const std::string& json, const std::vector<PoseBound>& bounds);

}  // namespace touchline::evaluate
