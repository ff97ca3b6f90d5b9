#include "firmware/arena_objects.h"

#include "hal/mock/arena.h"

namespace touchline {

void ArenaObjects::attach(hal::mock::Arena& arena) {
  const std::scoped_lock lock(mutex_, arena.mutex());
  arena_ = &arena;
  hal::mock::World& world = arena.world();
  if (!has_places_ || world.snapshot().robots.size() != places_.robots.size()) return;
  for (std::size_t i = 0; i < places_.robots.size(); ++i) world.place(i, places_.robots[i]);
  world.place_ball(places_.ball);
}

void ArenaObjects::detach() {
  const std::scoped_lock lock(mutex_);
  if (arena_ == nullptr) return;
  const std::scoped_lock arena_lock(arena_->mutex());
  places_ = arena_->world().snapshot();
  has_places_ = true;
  arena_ = nullptr;
}

Result<void> ArenaObjects::move(const PixelPoint& from, const PixelPoint& to) {
  const std::scoped_lock lock(mutex_);
  if (arena_ == nullptr) {
    return Error{ErrorCode::kUnsupported,
                 "only robots and ball of the arena can be moved here; move real ones by hand"};
  }
  const std::scoped_lock arena_lock(arena_->mutex());
  return arena_->move_object(from, to);
}

}  // namespace touchline
