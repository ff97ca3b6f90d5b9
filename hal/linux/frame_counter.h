#pragma once

#include <cstdint>

namespace touchline::hal {

/// Numbers frames so that each gap is as many frames as were lost.
class FrameCounter {
 public:
  void restart() { *this = FrameCounter{}; }
  /// `driver_sequence`: the driver's count. One that stands still is counted for, and followed when it comes right
  /// again; one that goes backwards begins anew, unless it comes right with the next frame. `periods`: so many frame
  /// times after the frame before, where the stamps tell; it counts when the driver's count tells of fewer.
  std::uint32_t count(std::uint32_t driver_sequence, std::uint32_t periods = 1);

  /// Since restart().
  [[nodiscard]] std::uint64_t lost() const { return lost_; }

 private:
  bool counted_ = false, was_back_ = false;
  std::uint32_t last_ = 0, driver_last_ = 0;
  std::uint32_t ahead_ = 0;  // frames that the driver's count has not told of
  std::uint64_t lost_ = 0;
};

}  // namespace touchline::hal
