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
  double motion_frames = 0.0;  // frames of all objects that were used
};

/// Measures the rolling shutter of a camera that stands from objects that are moved back and forth before it.
///
/// A row that is exposed later shows the object where it is later. An object that moves sideways with u pixels per
/// frame therefore leans by u t pixels per row, and one that moves down with v is longer by the factor 1 / (1 - v t),
/// with the time t between two rows in frame periods. Both change sign with the direction. What depends on the place of
/// the object (perspective, a light slope, an arm that turns at the elbow) or on its acceleration (a hand that lags)
/// does not: it is removed by regression for each object, t is the remaining slope over velocity (partial regression,
/// Frisch and Waugh 1933), and its uncertainty comes from blocks of half a second, whose errors may depend on each
/// other (cluster-robust covariance, Liang and Zeger 1986).
class ReadoutMeasurement {
 public:
  /// `rows`: of the luma picture; `period_s`: of the frames.
  ReadoutMeasurement(std::size_t rows, double period_s);
  /// `number`: of the frame; it increases, and gaps are lost frames.
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
