#include "firmware/arena_objects.h"

#include "hal/mock/arena.h"

namespace touchline {

void ArenaObjects::attach(hal::mock::Arena& arena, const std::array<std::string, 2>& colors, ArenaTimeControl time) {
  const std::scoped_lock lock(mutex_, arena.mutex());
  arena_ = &arena;
  colors_ = colors;
  time_ = time;
  if (!has_places_ || arena.world().snapshot().robots.size() != places_.robots.size()) return;
  for (std::size_t i = 0; i < places_.robots.size(); ++i) arena.game().rules().place_robot(i, places_.robots[i]);
  arena.game().rules().place_ball(places_.ball);
}

void ArenaObjects::attach(const hal::NetworkAddress& remote) {
  const std::scoped_lock lock(mutex_);
  remote_.emplace(remote);
}

void ArenaObjects::detach() {
  const std::scoped_lock lock(mutex_);
  remote_.reset();
  if (arena_ == nullptr) return;
  const std::scoped_lock arena_lock(arena_->mutex());
  places_ = arena_->world().snapshot();
  has_places_ = true;
  // The loop's last packets need time.
  arena_->pace().resume();
  arena_ = nullptr;
}

Result<void> ArenaObjects::control(const ArenaRequest& request) {
  using Kind = ArenaRequest::Kind;
  const std::scoped_lock lock(mutex_);
  if (remote_) return remote_->ask(request.text);
  if (arena_ == nullptr) {
    return Error{ErrorCode::kUnsupported, "this field is real: only an arena can be reset, paused or rearranged"};
  }
  const std::scoped_lock arena_lock(arena_->mutex());
  switch (request.kind) {
    case Kind::kReset:
      arena_->game().restart(request.seed);
      return {};
    case Kind::kPlace:
      return put_objects(request.places, colors_, arena_->parameters(), arena_->game());
    case Kind::kMove:
      return arena_->move_object(request.from, request.to);
    case Kind::kFault: {
      // Bounds the list; a game with more faults has them in its board file.
      constexpr std::size_t kMaxFaults = 1000;
      if (arena_->faults().size() >= kMaxFaults) {
        return failure(ErrorCode::kFull, "the arena has had %zu faults; start it again for more", kMaxFaults);
      }
      TOUCHLINE_TRY(check_robot(request.fault, arena_->parameters()));
      hal::mock::ArenaFault fault = request.fault;
      fault.at_s += seconds(arena_->now() - arena_->begin());
      arena_->inject(fault);
      return {};
    }
    default:
      return control_time(request);
  }
}

Result<void> ArenaObjects::control_time(const ArenaRequest& request) {
  using Kind = ArenaRequest::Kind;
  if (time_ == ArenaTimeControl::kNone) {
    return Error{ErrorCode::kUnsupported,
                 "a real device or another program takes part in the arena, so its time cannot be changed"};
  }
  hal::mock::ArenaPace& pace = arena_->pace();
  switch (request.kind) {
    case Kind::kPause:
      pace.pause();
      return {};
    case Kind::kStep:
      pace.step(request.frames);
      return {};
    case Kind::kSpeed:
      if (time_ != ArenaTimeControl::kSpeed) {
        return Error{ErrorCode::kUnsupported, "the arena runs as fast as possible; start it with --pace real"};
      }
      pace.set_speed(request.speed);
      return {};
    default:
      pace.resume();
      return {};
  }
}

}  // namespace touchline
