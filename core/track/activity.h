#pragma once

#include <algorithm>

namespace touchline {

/// Factor of the variance of a track's process noise, found from the innovations. 1 stands for the noise that the
/// parameters describe, and is the largest value.
class Activity {
 public:
  [[nodiscard]] double value() const { return value_; }
  void restore() { value_ = 1.0; }
  /// Follows the gradient of the innovation's log likelihood with respect to the logarithm of the process noise. An
  /// innovation beyond the gate raises the factor at once. `ratio`: squared innovation per degree of freedom.
  /// `predicted_share`: share of the innovation's variance that is not the sighting's noise, 0 to 1. `lower_limit`:
  /// smallest value of the factor.
  void follow(double ratio, bool is_beyond_gate, double predicted_share, double lower_limit) {
    constexpr double kGain = 0.2;
    const double change = is_beyond_gate ? ratio : 1.0 + kGain * predicted_share * (ratio - 1.0);
    scale(change, lower_limit);
  }

  /// See Pipeline::visit_state().
  template <class Self, class Archive>
  static void visit_state(Self& self, Archive& archive) {
    archive(self.value_);
  }

 protected:
  void scale(double change, double lower_limit) { value_ = std::clamp(change * value_, lower_limit, 1.0); }

 private:
  double value_ = 1.0;
};

/// Activity along one direction of motion without known commands. It also estimates by how much the sightings
/// understate the variance of their noise. The innovations of an optimal filter are white (Mehra 1970). If successive
/// innovations have one sign, the motion changes faster than predicted; if they alternate, the filter follows noise.
class FreeActivity : public Activity {
 public:
  /// Returns the factor of the variance of the sightings' noise, 1 to kMaxNoiseFactor.
  [[nodiscard]] double noise() const { return noise_; }
  void restore() {
    Activity::restore();
    former_ = 0.0;
  }
  /// `innovation` is in standard deviations. The other parameters are those of follow().
  void follow_direction(double innovation, bool is_beyond_gate, double lower_limit) {
    constexpr double kGain = 0.1, kMinRatio = 0.5, kMaxRatio = 2.0;
    const double excess = innovation * innovation - 1.0, product = innovation * former_;
    former_ = innovation;
    if (is_beyond_gate) return scale(std::max(1.0, 1.0 + excess), lower_limit);
    scale(std::max(kMinRatio, 1.0 + kGain * (product + std::min(0.0, excess))), lower_limit);
    // Persistent innovations do not count as noise.
    const double noisier = product < 0.0 ? excess : std::min(0.0, excess);
    noise_ = std::clamp(noise_ * std::min(kMaxRatio, 1.0 + kGain * noisier), 1.0, kMaxNoiseFactor);
  }

  /// See Pipeline::visit_state().
  template <class Self, class Archive>
  static void visit_state(Self& self, Archive& archive) {
    Activity::visit_state(self, archive);
    archive(self.noise_, self.former_);
  }

 private:
  // Sightings understate their standard deviation by a factor of three at most.
  static constexpr double kMaxNoiseFactor = 10.0;
  double noise_ = 1.0, former_ = 0.0;
};

}  // namespace touchline
