#include "core/track/command_history.h"

#include <algorithm>
#include <cmath>

namespace touchline {
namespace {

// No robot of any league is faster than these limits. They protect the filter state from overflow by an absurd command.
constexpr float kMaxSpeed = 20.0f, kMaxTurn = 200.0f;

float bounded(float value, float bound) { return std::isnan(value) ? 0.0f : std::clamp(value, -bound, bound); }

}  // namespace

void CommandHistory::clear() {
  first_ = size_ = 0;
  dropped_ = 0;
}

void CommandHistory::add(const Commands& commands, Instant acts_at) {
  while (size_ > 0 && entry(size_ - 1).acts_at >= acts_at) --size_;
  if (size_ == kCapacity) {
    first_ = (first_ + 1) % kCapacity;
    --size_;
    ++dropped_;
  }
  Entry& added = entries_[(first_ + size_) % kCapacity];
  ++size_;
  added.acts_at = acts_at;
  added.count = 0;
  if (commands.stop) return;  // then no robot is listed, so all must stand still
  for (const RobotCommand& robot : commands.robots) {
    added.ids[added.count] = robot.id;
    added.twists[added.count] = {bounded(robot.twist.v_mps, kMaxSpeed), bounded(robot.twist.w_radps, kMaxTurn)};
    ++added.count;
  }
}

void CommandHistory::forget_before(Instant instant) {
  while (size_ >= 2 && entry(1).acts_at <= instant) {
    first_ = (first_ + 1) % kCapacity;
    --size_;
  }
}

DriveInput CommandHistory::at(Instant instant, RobotId id) const {
  std::size_t i = size_;
  while (i > 0 && entry(i - 1).acts_at > instant) --i;
  if (i == 0) return {};
  const Entry& active = entry(i - 1);
  for (std::size_t k = 0; k < active.count; ++k) {
    if (active.ids[k] == id) return {true, active.twists[k]};
  }
  return {true, {}};
}

Instant CommandHistory::next_change(Instant instant, Instant limit) const {
  for (std::size_t i = 0; i < size_; ++i) {
    if (entry(i).acts_at > instant) return std::min(entry(i).acts_at, limit);
  }
  return limit;
}

}  // namespace touchline
