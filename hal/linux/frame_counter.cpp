#include "hal/linux/frame_counter.h"

#include <algorithm>
#include <utility>

namespace touchline::hal {
namespace {

constexpr std::uint32_t kBackward = 0x80000000u;  // half the range tells forward from backward

/// Steps from `a` to `b`; kBackward: none, or they lead back.
std::uint32_t forward(std::uint32_t a, std::uint32_t b) { return b == a ? kBackward : std::min(b - a, kBackward); }

}  // namespace

std::uint32_t FrameCounter::count(std::uint32_t driver_sequence, std::uint32_t periods) {
  const std::uint32_t driver_before = std::exchange(driver_last_, driver_sequence);
  if (!std::exchange(counted_, true)) return last_ = driver_sequence;
  // A count that was behind may come right again: what it then makes up for was counted before.
  std::uint32_t step = std::min(forward(driver_before, driver_sequence), forward(last_, driver_sequence));
  if (step == kBackward) step = 1;
  step = std::max(step, periods);
  lost_ += step - 1;
  return last_ += step;
}

}  // namespace touchline::hal
