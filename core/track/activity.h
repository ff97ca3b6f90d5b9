#pragma once

#include <algorithm>

namespace touchline {

/// Part of the process noise's variance that the innovations of a track show: at most 1, what the parameters describe.
class Activity {
 public:
  [[nodiscard]] double value() const { return value_; }
  void restore() { value_ = 1.0; }
  /// A step along the gradient of an innovation's likelihood by the logarithm of the process noise. An innovation
  /// beyond the gate raises it at once. `ratio`: squared innovation per degree of freedom. `predicted_share`: part of
  /// its variance that is not the sighting's noise, 0 to 1. `least`: the lower limit.
  void follow(double ratio, bool is_beyond_gate, double predicted_share, double least) {
    constexpr double kGain = 0.2;
    const double change = is_beyond_gate ? ratio : 1.0 + kGain * predicted_share * (ratio - 1.0);
    scale(change, least);
  }

 protected:
  void scale(double change, double least) { value_ = std::clamp(change * value_, least, 1.0); }

 private:
  double value_ = 1.0;
};

/// The same of motion without known commands, along one direction, and how much larger the noise of its sightings is
/// than they state. Innovations of a filter that knows both are not correlated (Mehra 1970): if successive ones have
/// the same sign, the motion changes faster than predicted; if they alternate, the filter follows noise.
class FreeActivity : public Activity {
 public:
  /// Factor of the variance of the sightings' noise, 1 to kMostNoise.
  [[nodiscard]] double noise() const { return noise_; }
  void restore() {
    Activity::restore();
    former_ = 0.0;
  }
  /// `innovation`: in standard deviations. Others as in follow().
  void follow_direction(double innovation, bool is_beyond_gate, double least) {
    constexpr double kGain = 0.1, kLeastChange = 0.5, kMostChange = 2.0;
    const double excess = innovation * innovation - 1.0, product = innovation * former_;
    former_ = innovation;
    if (is_beyond_gate) return scale(std::max(1.0, 1.0 + excess), least);
    scale(std::max(kLeastChange, 1.0 + kGain * (product + std::min(0.0, excess))), least);
    // Innovations that persist are no noise.
    const double noisier = product < 0.0 ? excess : std::min(0.0, excess);
    noise_ = std::clamp(noise_ * std::min(kMostChange, 1.0 + kGain * noisier), 1.0, kMostNoise);
  }

 private:
  // Sightings state their standard deviation at least to a factor of three.
  static constexpr double kMostNoise = 10.0;
  double noise_ = 1.0, former_ = 0.0;
};

}  // namespace touchline
