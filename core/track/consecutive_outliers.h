#pragma once

#include <cmath>

#include "core/types.h"

namespace touchline {

/// Consecutive sightings that a filter's gate rejected. A single outlier is an error of the vision. Several consistent
/// outliers show that the object was moved (a collision, a hand), so the filter must be reset (paper, section 6.1).
class ConsecutiveOutliers {
 public:
  struct Outlier {
    Pose pose;
    bool has_heading = false;
    Instant when{};

    template <class Self, class Archive>
    static void visit_state(Self& self, Archive& archive) {
      auto& [pose, has_heading, when] = self;
      archive(pose, has_heading, when);
    }
  };

  void clear() { count_ = 0; }
  /// `reach_m`: largest distance between simultaneous sightings of one object. `max_speed_mps`: the object's largest
  /// speed.
  void add(const Outlier& outlier, double reach_m, double max_speed_mps) {
    const bool fits = count_ > 0 && within_reach(last_.pose.position, last_.when, outlier, reach_m, max_speed_mps);
    if (!fits) {
      first_ = outlier;
      count_ = 0;
    }
    last_ = outlier;
    ++count_;
  }
  [[nodiscard]] int count() const { return count_; }
  [[nodiscard]] const Outlier& first() const { return first_; }
  [[nodiscard]] const Outlier& last() const { return last_; }

  /// Returns true if an object that was at `from` at time `then` can have reached the outlier.
  static bool within_reach(FieldPoint from, Instant then, const Outlier& outlier, double reach_m,
                           double max_speed_mps) {
    const double distance = std::hypot(static_cast<double>(outlier.pose.position.x_m - from.x_m),
                                       static_cast<double>(outlier.pose.position.y_m - from.y_m));
    return distance <= reach_m + max_speed_mps * seconds(outlier.when - then);
  }

  /// See Pipeline::visit_state().
  template <class Self, class Archive>
  static void visit_state(Self& self, Archive& archive) {
    auto& [first, last, count] = self;
    archive(first, last, count);
  }

 private:
  Outlier first_, last_;
  int count_ = 0;
};

}  // namespace touchline
