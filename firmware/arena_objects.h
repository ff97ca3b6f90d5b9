#pragma once

#include <mutex>

#include "core/types.h"
#include "hal/mock/world.h"
#include "hal/result.h"

namespace touchline {

namespace hal::mock {
class Arena;
}

/// Lets the console move robots and ball of a simulated field, as a person does on a real one. They stay where they are
/// when another session begins, with an arena of its own. Any thread may call it.
class ArenaObjects {
 public:
  /// This arena is the field now. If it has as many robots as the last one, they and the ball are put where they were.
  void attach(hal::mock::Arena& arena);
  /// The arena is about to be destroyed: remembers where everything is.
  void detach();
  /// hal::mock::Arena::move_object(). kUnsupported: the field is real.
  Result<void> move(const PixelPoint& from, const PixelPoint& to);

 private:
  std::mutex mutex_;
  hal::mock::Arena* arena_ = nullptr;
  hal::mock::Snapshot places_;
  bool has_places_ = false;
};

}  // namespace touchline
