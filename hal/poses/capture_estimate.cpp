#include "hal/poses/capture_estimate.h"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace touchline::hal {
namespace {

constexpr Duration kPeriod = std::chrono::seconds(5);
// A difference that is larger by this is a sender's clock that was set back. No packet is on its way for so long.
constexpr Duration kLeap = std::chrono::seconds(1);
// Times of more than 100 years do not fit into nanoseconds.
constexpr double kLatest_s = 3e9;

}  // namespace

Instant CaptureEstimate::capture_time(std::optional<double> captured_s, std::optional<double> sent_s, Instant arrival) {
  const auto is_usable = [](std::optional<double> time_s) { return time_s && std::abs(*time_s) < kLatest_s; };
  if (!is_usable(captured_s)) return arrival;
  const double sent = is_usable(sent_s) ? std::max(*sent_s, *captured_s) : *captured_s;
  const Duration difference = arrival.time_since_epoch() - from_seconds(sent);
  if (!has_difference_ || difference - std::min(recent_, former_) > kLeap) {
    has_difference_ = true;
    recent_ = former_ = difference;
    begin_ = arrival;
  } else if (arrival - begin_ > kPeriod) {
    former_ = recent_;
    recent_ = difference;
    begin_ = arrival;
  }
  recent_ = std::min(recent_, difference);
  return std::min(Instant(from_seconds(*captured_s) + std::min(recent_, former_)), arrival);
}

}  // namespace touchline::hal
