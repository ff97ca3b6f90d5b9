#pragma once

#include "core/time.h"

namespace touchline::hal {

/// Makes a quiet input of a contact that bounces, from its edges and their times. A level counts once it has lasted for
/// the debounce time; a shorter pulse does nothing, also when it came and went between two looks, and a longer one is
/// seen even so.
class Debouncer {
 public:
  /// What was seen since the last look.
  struct View {
    bool active = false;                    // at any time since then
    bool activated = false;                 // became active
    bool restless = false;                  // no level has lasted for so long that this is no bouncing any more
    Duration settles_in = Duration::max();  // when a level that is new will have lasted long enough; max(): none is
  };

  /// `active` counts from the start. Time 0: every level counts at once (somebody else debounces).
  void begin(Duration time, bool active, Instant now);
  /// In the order of time. An edge to the level that was there already tells that one in between was missed.
  void edge(bool active, Instant at);
  /// As edge(), when nothing but the level is known.
  void level(bool active, Instant now) {
    if (active != raw_) edge(active, now);
  }
  View look(Instant now);

 private:
  void settle(Instant until);

  Duration time_{};
  bool stable_ = false, raw_ = false;
  Instant since_{};           // of the raw level
  Instant restless_since_{};  // only while the raw level is new
  bool was_active_ = false, activated_ = false;
};

}  // namespace touchline::hal
