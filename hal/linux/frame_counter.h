#pragma once

#include <cstdint>

namespace touchline::hal {

/// Numbers frames so that each gap in the numbers is the number of lost frames.
class FrameCounter {
 public:
  void restart() { *this = FrameCounter{}; }
  /// Returns the number of a frame. `driver_sequence`: the driver's sequence number. If it repeats or decreases, the
  /// frame still gets the next number. After a repeated number, the driver's numbers apply again once they continue.
  /// After a decrease, gaps are counted from the lower number, unless the next frame continues the former numbers.
  /// `periods`: number of frame periods since the previous frame, if the time stamps show it; it applies if it is
  /// larger than the difference of the driver's numbers.
  std::uint32_t count(std::uint32_t driver_sequence, std::uint32_t periods = 1);

  /// Returns the number of lost frames since restart().
  [[nodiscard]] std::uint64_t lost() const { return lost_; }

 private:
  bool counted_ = false, was_back_ = false;
  std::uint32_t last_ = 0, driver_last_ = 0;
  std::uint32_t ahead_ = 0;  // lost frames that the driver's numbers do not contain
  std::uint64_t lost_ = 0;
};

}  // namespace touchline::hal
