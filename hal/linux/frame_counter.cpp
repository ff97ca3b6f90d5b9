#include "hal/linux/frame_counter.h"

#include <algorithm>
#include <utility>

namespace touchline::hal {
namespace {

constexpr std::uint32_t kDecrease = 0x80000000u;  // larger differences mean that the number decreased

}  // namespace

std::uint32_t FrameCounter::count(std::uint32_t driver_sequence, std::uint32_t periods) {
  std::uint32_t step = driver_sequence - std::exchange(driver_last_, driver_sequence);
  if (!std::exchange(counted_, true)) return last_ = driver_sequence;
  const bool is_back = step >= kDecrease;
  // After the driver has restarted its numbers or delivered one wrong number, no frames are missing.
  if (is_back || (was_back_ && driver_sequence == last_ + 1)) {
    step = 1;
    ahead_ = 0;
  }
  was_back_ = is_back;
  // If the driver's numbers lagged behind and now jump, the frames in the jump are already counted.
  const std::uint32_t already_counted = std::min(ahead_, std::max(step, 1u) - 1);
  const std::uint32_t counted = std::max({step - already_counted, periods, 1u});
  ahead_ += counted - step;
  lost_ += counted - 1;
  return last_ += counted;
}

}  // namespace touchline::hal
