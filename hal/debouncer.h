#pragma once

#include "core/time.h"

namespace touchline::hal {

/// Debounces an input from its edges and their times. A level is accepted once it has lasted for the debounce time.
/// Shorter pulses are ignored; longer ones are detected even if they begin and end between two calls of poll().
class Debouncer {
 public:
  /// State of the input since the last poll().
  struct State {
    bool active = false;                    // active at any time since the last poll()
    bool activated = false;                 // the input has changed to active
    bool bouncing = false;                  // the input has been changing for longer than a contact bounces
    Duration settles_in = Duration::max();  // time until a new level is accepted; max(): there is no new level
  };

  /// `active`: the level at the beginning. `time`: the debounce time; 0 if the kernel debounces: every level is
  /// accepted immediately.
  void begin(Duration time, bool active, Instant now);
  /// Call it in the order of time. An edge to the current level means that the edge before it was lost.
  void edge(bool active, Instant at);
  /// As edge(), for an input of which only the level is known.
  void level(bool active, Instant now) {
    if (active != raw_) edge(active, now);
  }
  State poll(Instant now);

 private:
  void settle(Instant until);

  Duration time_{};
  bool stable_ = false, raw_ = false;
  Instant since_{};           // time at which the raw level began
  Instant bouncing_since_{};  // raw level, valid while it is not accepted yet
  bool was_active_ = false, activated_ = false;
};

}  // namespace touchline::hal
