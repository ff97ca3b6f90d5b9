#include "firmware/console/link_control.h"

#include <algorithm>

namespace touchline::console {
namespace {

// Each step has about 0.6 times the bytes of the one before.
struct LadderStep {
  int factor, quality;
};
constexpr std::array<LadderStep, 7> kLadder{{{1, 80}, {1, 60}, {1, 40}, {2, 60}, {2, 40}, {4, 50}, {4, 30}}};
constexpr int kMaxDivisor = 8;
// A larger picture is tried after one or two seconds without delay.
constexpr int kGoodBeforeLarger = 20;

}  // namespace

void LinkControl::set(int divisor, Duration period) {
  divisor_ = std::clamp(divisor, 1, kMaxDivisor);
  period_ = period;
}

PictureLevel LinkControl::level() const {
  return {std::min(divisor_ * kLadder[step_].factor, kMaxDivisor), kLadder[step_].quality};
}

void LinkControl::sent(std::uint64_t number, std::size_t bytes, Instant now) {
  if (waiting_ < kMaxUnacknowledged) pictures_[waiting_++] = {number, bytes, now};
}

void LinkControl::seen(std::uint64_t number, Instant now, Duration round_trip) {
  std::size_t done = 0;
  while (done < waiting_ && pictures_[done].number <= number) ++done;
  if (done == 0) return;
  measure(pictures_[done - 1], now - pictures_[done - 1].time, round_trip);
  std::rotate(pictures_.begin(), pictures_.begin() + static_cast<std::ptrdiff_t>(done), pictures_.end());
  waiting_ -= done;
}

void LinkControl::measure(const SentPicture& picture, Duration delay, Duration round_trip) {
  delay_ = delay;
  const Duration transfer = std::max<Duration>(delay - round_trip, std::chrono::microseconds(100));
  const double rate = static_cast<double>(picture.bytes) / seconds(transfer);
  throughput_ = throughput_ == 0.0 ? rate : 0.8 * throughput_ + 0.2 * rate;
  // What does not arrive within a period queues up before the next picture.
  if (transfer > period_) {
    good_in_sequence_ = 0;
    if (step_ + 1 < kLadder.size()) ++step_;
  } else if (transfer < period_ / 2 && ++good_in_sequence_ >= kGoodBeforeLarger) {
    good_in_sequence_ = 0;
    if (step_ > 0) --step_;
  }
}

}  // namespace touchline::console
