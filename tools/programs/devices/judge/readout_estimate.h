#pragma once

#include <cstdint>
#include <deque>
#include <vector>

#include "tools/programs/devices/judge/moving_objects.h"

namespace touchline::devices {

/// Time from the exposure of the first row to that of the last row, in frame periods.
struct ReadoutEstimate {
  bool known = false;
  double readout = 0.0, sigma = 0.0;
  double motion_frames = 0.0;  // frames used, summed over all objects
};

/// Measures the rolling shutter of a camera at rest from objects that are moved back and forth in front of it.
///
/// A row that is exposed later shows the object at a later position. Let t be the time between two rows in frame
/// periods. An object that moves horizontally by u pixels per frame leans by u t pixels per row, and an object that
/// moves down by v is longer by the factor 1 / (1 - v t). Both effects change sign with the direction. Effects of the
/// object's position (perspective, a light slope, an arm that turns at the elbow) and of its acceleration (a hand that
/// lags) do not change sign. Regression removes them for each object; t is the remaining slope over velocity (partial
/// regression, Frisch and Waugh 1933). The uncertainty of t comes from blocks of half a second, within which errors may
/// be correlated (cluster-robust covariance, Liang and Zeger 1986).
class ReadoutMeasurement {
 public:
  /// `rows`: of the luma picture; `period_s`: of the camera's frames.
  ReadoutMeasurement(std::size_t rows, double period_s);
  /// `number`: frame number, which increases; gaps are lost frames.
  void add(std::uint32_t number, const std::vector<MovingObject>& objects);
  [[nodiscard]] ReadoutEstimate estimate() const;

 private:
  struct Sample {
    std::uint32_t number = 0;
    MovingObject object;
  };
  using Track = std::vector<Sample>;

  [[nodiscard]] bool belongs(const Track& track, const Sample& sample) const;
  [[nodiscard]] static bool is_evenly_spaced(const Track& track, std::size_t middle, std::uint32_t step);

  std::size_t rows_;
  std::size_t block_frames_;
  std::deque<Track> tracks_;
};

}  // namespace touchline::devices
