#include "hal/linux/frame_counter.h"

#include <algorithm>
#include <utility>

namespace touchline::hal {

std::uint32_t FrameCounter::count(std::uint32_t driver_sequence, std::uint32_t periods) {
  if (!std::exchange(counted_, true)) return last_ = driver_sequence;
  std::uint32_t step = driver_sequence - last_;
  if (step == 0 || step >= 0x80000000u) step = 1;  // half the range tells forward from backward
  step = std::max(step, periods);
  lost_ += step - 1;
  return last_ += step;
}

}  // namespace touchline::hal
