#include "hal/debouncer.h"

#include <algorithm>

namespace touchline::hal {
namespace {

// Contacts bounce for some milliseconds; what goes on for longer is a loose wire.
constexpr Duration kLongestBounce = std::chrono::milliseconds(50);

}  // namespace

void Debouncer::begin(Duration time, bool active, Instant now) {
  *this = {};
  time_ = time;
  stable_ = raw_ = was_active_ = active;
  since_ = now - time;
  restless_since_ = now;  // an edge may have come just before
}

void Debouncer::settle(Instant until) {
  if (raw_ == stable_ || until - since_ < time_) return;
  stable_ = raw_;
  was_active_ = was_active_ || stable_;
  activated_ = activated_ || stable_;
}

void Debouncer::edge(bool active, Instant at) {
  settle(at);
  if (at - since_ >= time_) restless_since_ = at;
  raw_ = active;
  since_ = at;
}

Debouncer::View Debouncer::look(Instant now) {
  settle(now);
  View view;
  const bool settled = now - since_ >= time_;
  view.active = was_active_;
  view.activated = activated_;
  view.restless = !settled && now - restless_since_ >= std::max(kLongestBounce, 2 * time_);
  if (raw_ != stable_) view.settles_in = since_ + time_ - now;
  was_active_ = stable_;
  activated_ = false;
  return view;
}

}  // namespace touchline::hal
