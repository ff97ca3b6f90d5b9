#pragma once

#include <cstdint>

namespace touchline::hal {

/// Numbers frames so that each gap is as many frames as were lost.
class FrameCounter {
 public:
  void restart() { *this = FrameCounter{}; }
  /// `driver_sequence`: the driver's count. One that stands still or goes backwards is counted for, and its later gaps
  /// are seen; one that comes right again is followed. `periods`: so many frame times after the frame before, where the
  /// stamps tell; it counts when the driver's count tells of fewer.
  std::uint32_t count(std::uint32_t driver_sequence, std::uint32_t periods = 1);

  /// Since restart().
  [[nodiscard]] std::uint64_t lost() const { return lost_; }

 private:
  bool counted_ = false;
  std::uint32_t last_ = 0, driver_last_ = 0;
  std::uint64_t lost_ = 0;
};

}  // namespace touchline::hal
