#pragma once

#include "core/types.h"

namespace touchline {

/// Detects that nearly all robots, and the ball, are suddenly seen elsewhere: the picture was rotated, mirrored, or
/// comes from another camera. (Robots that are carried or covered vanish one after the other before they are seen
/// elsewhere.)
class TrackJump {
 public:
  void restart() { frames_ = 0; }
  /// `before`: tracks of the previous frame; `sightings`: of this frame. Returns whether two frames in a row contradict
  /// the tracks. A single one can be a damaged picture, which the tracks survive.
  bool check(const Tracks& before, const Sightings& sightings, Instant now);

 private:
  int frames_ = 0;  // number of consecutive frames that contradict
};

}  // namespace touchline
