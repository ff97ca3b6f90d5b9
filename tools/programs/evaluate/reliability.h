#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "tools/programs/evaluate/records.h"

namespace touchline::evaluate {

/// Counts how often reports of a certain confidence are right. Confidence is calibrated if, for example, nine in ten
/// reports with 0.9 are right.
class Reliability {
 public:
  struct Bin {
    double low = 0.0, high = 0.0;  // range of confidence, low <= c < high; the last bin includes 1
    std::size_t count = 0, right = 0;
    double confidence_sum = 0.0;
  };

  /// Adds a report with its confidence in [0, 1]; a report without one (nullopt) is not counted.
  void add(std::optional<double> confidence, bool right);
  void add(const Reliability& other);

  [[nodiscard]] std::size_t count() const;
  /// Returns the expected calibration error: the difference between mean confidence and share of right reports in each
  /// bin, averaged over all reports (Guo et al. 2017, On Calibration of Modern Neural Networks, eq. 5). 0 without
  /// reports.
  [[nodiscard]] double calibration_error() const;
  [[nodiscard]] const auto& bins() const { return bins_; }

 private:
  // Bins are narrow where most reports are: half of all errors are in the last tenth.
  std::array<Bin, 8> bins_{
      {{0.0, 0.5}, {0.5, 0.6}, {0.6, 0.7}, {0.7, 0.8}, {0.8, 0.9}, {0.9, 0.95}, {0.95, 0.99}, {0.99, 1.0}}};
};

/// Reliability of a scene's sightings or tracks.
struct ReliabilityOfScene {
  Reliability named, unnamed;  // robots with and without an id
  Reliability ball;

  void add(const ReliabilityOfScene& other);
  void add_robot(const RobotRecord& robot, bool right) {
    (robot.id.has_value() ? named : unnamed).add(robot.confidence, right);
  }
  /// Returns all reports together.
  [[nodiscard]] Reliability all() const;
};

}  // namespace touchline::evaluate
