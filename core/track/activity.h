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
    value_ = std::clamp(change * value_, least, 1.0);
  }

 private:
  double value_ = 1.0;
};

}  // namespace touchline
