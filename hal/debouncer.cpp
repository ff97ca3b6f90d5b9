#include "hal/debouncer.h"

#include <algorithm>

namespace touchline::hal {
namespace {

// Longest time that a contact may bounce; usually it bounces for some milliseconds. An input that keeps changing for
// longer has a loose wire.
constexpr Duration kMaxBounce = std::chrono::milliseconds(50);

}  // namespace

void Debouncer::begin(Duration time, bool active, Instant now) {
  *this = {};
  time_ = time;
  stable_ = raw_ = was_active_ = active;
  since_ = now - time;
  bouncing_since_ = now;  // there may have been an edge just before this time
}

void Debouncer::settle(Instant until) {
  if (raw_ == stable_ || until - since_ < time_) return;
  stable_ = raw_;
  was_active_ = was_active_ || stable_;
  activated_ = activated_ || stable_;
}

void Debouncer::edge(bool active, Instant at) {
  settle(at);
  if (at - since_ >= time_) bouncing_since_ = at;
  raw_ = active;
  since_ = at;
}

Debouncer::State Debouncer::poll(Instant now) {
  settle(now);
  State state;
  const bool settled = now - since_ >= time_;
  state.active = was_active_;
  state.activated = activated_;
  state.bouncing = !settled && now - bouncing_since_ >= std::max(kMaxBounce, 2 * time_);
  if (raw_ != stable_) state.settles_in = since_ + time_ - now;
  was_active_ = stable_;
  activated_ = false;
  return state;
}

}  // namespace touchline::hal
