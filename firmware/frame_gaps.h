#pragma once

#include <cstdint>
#include <optional>

namespace touchline {

/// Counts the frames that are missing between the sequence numbers of a camera's driver.
class FrameGaps {
 public:
  /// Returns the number of frames lost between the previous frame and this one: none if the number repeats or
  /// decreases.
  std::uint64_t lost_before(std::uint32_t sequence) {
    // The difference is signed, because the numbers wrap around.
    const auto step = static_cast<std::int32_t>(sequence - last_.value_or(sequence - 1));
    last_ = sequence;
    return step > 1 ? static_cast<std::uint64_t>(step - 1) : 0;
  }
  /// Call it when the driver begins to count anew.
  void restart() { last_.reset(); }

 private:
  std::optional<std::uint32_t> last_;
};

}  // namespace touchline
