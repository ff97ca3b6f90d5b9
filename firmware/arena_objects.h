#pragma once

#include <mutex>

#include "core/types.h"
#include "hal/mock/world.h"
#include "hal/result.h"

namespace touchline {

namespace hal::mock {
class Arena;
}

/// Lets the console move robots and ball of a simulated field, as a person does on a real one. If another session
/// begins with a new arena, robots and ball keep their positions. Any thread may call it.
class ArenaObjects {
 public:
  /// Makes this arena the field. If it has as many robots as the last arena, robots and ball are put where they were.
  void attach(hal::mock::Arena& arena);
  /// Remembers where everything is; call it before the arena is destroyed.
  void detach();
  /// Moves an object as hal::mock::Arena::move_object() does. kUnsupported: the field is real.
  Result<void> move(const PixelPoint& from, const PixelPoint& to);

 private:
  std::mutex mutex_;
  hal::mock::Arena* arena_ = nullptr;
  hal::mock::Snapshot places_;
  bool has_places_ = false;
};

}  // namespace touchline
