#pragma once

#include <array>
#include <mutex>
#include <optional>
#include <string>

#include "core/types.h"
#include "firmware/arena_places.h"
#include "firmware/remote_arena.h"
#include "hal/mock/world.h"
#include "hal/result.h"

namespace touchline {

namespace hal::mock {
class Arena;
}

/// Which parts of its time an arena controls.
enum class ArenaTimeControl : std::uint8_t {
  kNone,   // a real device takes part, so the time is the computer's
  kPause,  // it can stand still, but runs as fast as possible
  kSpeed   // it can also pass faster and slower
};

/// Lets consoles and other programs control a simulated field: move robots and ball, as a person does on a real one,
/// and reset it, stop its time and inject faults. If another session begins with a new arena, robots and ball keep
/// their positions. Any thread may call it.
class ArenaObjects {
 public:
  /// Makes this arena the field. If it has as many robots as the last arena, robots and ball are put where they were.
  /// `colors`: names of the teams, by Side.
  void attach(hal::mock::Arena& arena, const std::array<std::string, 2>& colors = {"blue", "yellow"},
              ArenaTimeControl time = ArenaTimeControl::kSpeed);
  /// Remembers where everything is; call it before the arena is destroyed. After this, the field is real.
  void detach();
  /// Makes an arena in another process the field: requests are passed on to it.
  void attach(const hal::NetworkAddress& remote);
  /// Carries out a request. kUnsupported: the field is real, or its time is the computer's. Errors of put_objects(),
  /// hal::mock::Arena::move_object() and RemoteArena::ask().
  Result<void> control(const ArenaRequest& request);

 private:
  Result<void> control_time(const ArenaRequest& request);

  std::mutex mutex_;
  hal::mock::Arena* arena_ = nullptr;
  std::optional<RemoteArena> remote_;
  std::array<std::string, 2> colors_;
  ArenaTimeControl time_ = ArenaTimeControl::kNone;
  hal::mock::Snapshot places_;
  bool has_places_ = false;
};

}  // namespace touchline
