#include "firmware/console/frame_feed.h"

namespace touchline::console {

void FrameFeed::read() {
  while (reader_.read((*kept_)[count_ % kKept])) {
    count(slot(count_));
    ++count_;
  }
}

const Snapshot* FrameFeed::find(std::uint64_t number) const {
  // Skip the slot of the next snapshot, because writing to it may have begun.
  for (std::uint64_t back = 1; back < kKept && back <= count_; ++back) {
    const Snapshot& snapshot = slot(count_ - back);
    if (snapshot.number == number) return &snapshot;
    if (snapshot.number < number) break;
  }
  return nullptr;
}

std::vector<Snapshot> FrameFeed::last(Duration time) const {
  std::uint64_t first = count_;
  while (first > 0 && count_ - first + 1 < kKept &&
         slot(count_ - 1).machine_sent - slot(first - 1).machine_sent <= time) {
    --first;
  }
  std::vector<Snapshot> snapshots;
  snapshots.reserve(count_ - first);
  for (; first < count_; ++first) snapshots.push_back(slot(first));
  return snapshots;
}

void FrameFeed::count(const Snapshot& snapshot) {
  latency_.add(snapshot.latency);
  const Duration processing = snapshot.latency - (snapshot.received - snapshot.captured);
  if (frame_period_ > Duration::zero() && processing > frame_period_) ++missed_deadlines_;
  const Snapshot* const before = newest();
  if (before == nullptr || snapshot.number != before->number + 1) return;
  // The type is signed, because a reopened camera counts from the beginning.
  const auto step = static_cast<std::int32_t>(snapshot.frame_sequence - before->frame_sequence);
  if (step > 1) lost_frames_ += static_cast<std::uint64_t>(step - 1);
}

void FrameFeed::next_second() {
  latency_.next_second();
  rate_hz_ = count_ - counted_before_;
  counted_before_ = count_;
}

}  // namespace touchline::console
