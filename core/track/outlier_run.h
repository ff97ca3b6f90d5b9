#pragma once

#include <cmath>

#include "core/types.h"

namespace touchline {

/// Sightings in a row that a filter's gate refused. One alone is a fault of the vision; several that fit each other
/// say that the world has changed (a collision, a hand), and the filter has to start over (paper, section 6.1).
class OutlierRun {
 public:
  struct Outlier {
    Pose pose;
    bool has_heading = false;
    Instant when{};
  };

  void clear() { count_ = 0; }
  /// `reach_m`: how far apart sightings of one object may be at once; `max_speed_mps`: of the object.
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

  /// Whether an object that was at `from` then can be where the outlier is.
  static bool within_reach(FieldPoint from, Instant then, const Outlier& outlier, double reach_m,
                           double max_speed_mps) {
    const double way = std::hypot(static_cast<double>(outlier.pose.position.x_m - from.x_m),
                                  static_cast<double>(outlier.pose.position.y_m - from.y_m));
    return way <= reach_m + max_speed_mps * seconds(outlier.when - then);
  }

 private:
  Outlier first_, last_;
  int count_ = 0;
};

}  // namespace touchline
