#pragma once

#include "core/types.h"

namespace touchline {

/// Notices that nearly all robots, and the ball, are seen elsewhere at once: the picture was turned, mirrored, or comes
/// from another camera. Robots that are carried, or that are covered, vanish one after the other and before they are
/// seen elsewhere.
class TrackJump {
 public:
  void restart() { frames_ = 0; }
  /// `before`: tracks of the frame before; `sightings`: of this frame. Returns whether this frame and the one before
  /// contradict the tracks. A single one can be a damaged picture, which the tracks survive.
  bool check(const Tracks& before, const Sightings& sightings, Instant now);

 private:
  int frames_ = 0;  // in a row
};

}  // namespace touchline
