#pragma once

#include "core/track/activity.h"
#include "core/track/consecutive_outliers.h"
#include "core/track/life_cycle.h"
#include "core/track/point_filter.h"
#include "core/track/track_parameters.h"

namespace touchline {

/// The track of the ball. Its process noise follows the innovations: a freely rolling ball needs less than one that
/// robots fight for. A sighting beyond the gate may show a bounce or a hit since the last sighting.
class TrackedBall {
 public:
  void lose();
  /// Predicts from `from`, the time of the last call, to `now`, and fuses the sighting, if there is one.
  void update(const BallSighting& sighting, Instant from, Instant now, const TrackParameters& parameters);
  /// Returns the prediction from `from`, the time of the last update, to `now`; unknown if the ball was unseen for
  /// long.
  [[nodiscard]] ExpectedBall expected(Instant from, Instant now, const TrackParameters& parameters) const;
  /// Reports the track at `now`, the time of the last update, and its prediction to `action`.
  void report(Instant now, Instant action, const TrackParameters& parameters, BallTrack& out) const;

  /// See Pipeline::visit_state().
  template <class Self, class Archive>
  static void visit_state(Self& self, Archive& archive) {
    auto& [filter, life, outliers, last_position, confidence, innovation2, activity, lasting_m, lasting_since, same] =
        self;
    archive(filter, life, outliers, last_position, confidence, innovation2, activity, lasting_m, lasting_since, same);
  }

 private:
  // Standard deviations along one axis.
  struct Errors {
    double white_m = 0.0, lasting_m = 0.0;
  };
  static Errors errors_of(const BallSighting& sighting, const BallFilterParameters& parameters);

  bool fuse(const BallSighting& sighting, Instant now, const TrackParameters& parameters);
  void start(const BallSighting& sighting, const PointFilter::Velocity& velocity, const Errors& errors);
  /// Decorrelates the lasting error by the motion to the sighting. Returns the share that is left since the last
  /// sighting.
  double renew_lasting_error(const BallSighting& sighting, const Errors& errors);

  PointFilter filter_;
  LifeCycle life_;
  ConsecutiveOutliers outliers_;
  FieldPoint last_position_;   // position at the last sighting
  float confidence_ = 0.0f;    // confidence of the last sighting
  float innovation2_ = -1.0f;  // as in BallTrack
  Activity activity_;
  // The lasting error: its standard deviation, the position since which it decorrelates, and the correlation that is
  // left.
  double lasting_m_ = 0.0;
  FieldPoint lasting_since_;
  double same_ = 1.0;
};

}  // namespace touchline
