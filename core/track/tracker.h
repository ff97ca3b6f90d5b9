#pragma once

#include "core/types.h"

namespace touchline {

struct TrackParameters {};  // process and measurement noise, gates, life cycle; see tracker's owner

/// One extended Kalman filter a robot, eq. (4)-(9), and one Kalman filter for the ball, eq. (10), (11).
class Tracker {
 public:
  Status configure(const TrackParameters& parameters);
  void reset();
  /// Commands that will act on the robots from `acts_at` until the next ones do.
  void commanded(const Commands& commands, Instant acts_at);
  /// Fuses at `capture_time` and predicts to `action_time`; out lists tracks that are not lost, own team first, by id.
  void update(const Sightings& sightings, Instant capture_time, Instant action_time, Tracks& out);
};

}  // namespace touchline
