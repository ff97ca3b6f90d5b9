#include "firmware/console/link_control.h"

#include <algorithm>

namespace touchline::console {
namespace {

// A combination of size and quality; each has about 0.6 times the bytes of the previous one.
struct LadderStep {
  int factor, quality;
};
constexpr std::array<LadderStep, 7> kLadder{{{1, 80}, {1, 60}, {1, 40}, {2, 60}, {2, 40}, {4, 50}, {4, 30}}};
constexpr int kMaxDivisor = 8;
// Number of fast deliveries after which a larger picture is tried: half a second without delay.
constexpr int kGoodBeforeLarger = 8;

}  // namespace

void LinkControl::set(int divisor, Duration period) {
  divisor_ = std::clamp(divisor, 1, kMaxDivisor);
  period_ = period;
}

PictureLevel LinkControl::level() const {
  return {std::min(divisor_ * kLadder[step_].factor, kMaxDivisor), kLadder[step_].quality};
}

void LinkControl::sent(std::uint64_t number, std::size_t bytes, std::uint64_t end, Instant now) {
  if (waiting_ < kMaxUnacknowledged) numbers_[waiting_++] = number;
  if (measured_ < on_the_way_.size()) on_the_way_[measured_++] = {bytes, end, now};
}

void LinkControl::seen(std::uint64_t number) {
  std::size_t done = 0;
  while (done < waiting_ && numbers_[done] <= number) ++done;
  std::rotate(numbers_.begin(), numbers_.begin() + static_cast<std::ptrdiff_t>(done), numbers_.end());
  waiting_ -= done;
}

void LinkControl::delivered(std::uint64_t position, Instant now, Duration round_trip) {
  std::size_t done = 0;
  for (; done < measured_ && on_the_way_[done].end <= position; ++done) {
    const OnTheWay& picture = on_the_way_[done];
    // If a picture waited for the previous one, its transfer began only when that one had arrived.
    const bool has_waited = picture.sent + round_trip < last_delivered_;
    judge(has_waited ? now - last_delivered_ : now - picture.sent - round_trip, picture.bytes);
    last_delivered_ = now;
  }
  std::rotate(on_the_way_.begin(), on_the_way_.begin() + static_cast<std::ptrdiff_t>(done), on_the_way_.end());
  measured_ -= done;
}

void LinkControl::judge(Duration transfer, std::size_t bytes) {
  const double rate =
      static_cast<double>(bytes) / seconds(std::max<Duration>(transfer, std::chrono::microseconds(100)));
  throughput_ = throughput_ == 0.0 ? rate : 0.8 * throughput_ + 0.2 * rate;
  // A picture that takes longer than a period delays the next one.
  if (transfer > period_) {
    good_in_sequence_ = 0;
    if (step_ + 1 < kLadder.size()) ++step_;
  } else if (transfer < period_ / 2 && ++good_in_sequence_ >= kGoodBeforeLarger) {
    good_in_sequence_ = 0;
    if (step_ > 0) --step_;
  }
}

}  // namespace touchline::console
