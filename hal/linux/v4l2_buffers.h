#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "hal/linux/v4l2_device.h"

struct v4l2_buffer;

namespace touchline::hal {

/// The driver's buffers, mapped into our memory, and who has each: the driver or the loop. Errors are errnos.
class V4l2Buffers {
 public:
  // VIDEO_MAX_FRAME of the kernel.
  static constexpr std::size_t kMax = 32;

  /// Asks for `count` and maps what is granted.
  [[nodiscard]] int map(const V4l2Device& device, std::size_t count);
  void unmap(const V4l2Device& device) noexcept;
  [[nodiscard]] std::size_t count() const { return count_; }

  /// Hands all buffers to the driver.
  [[nodiscard]] int queue_all(const V4l2Device& device);
  /// Hands one back; nothing happens when the driver has it already.
  [[nodiscard]] int queue(const V4l2Device& device, std::size_t index);
  /// Takes the oldest filled one. EAGAIN: none is filled.
  [[nodiscard]] int dequeue(const V4l2Device& device, v4l2_buffer& buffer);
  /// After the end of streaming the driver holds none.
  void forget_queue();
  [[nodiscard]] std::size_t queued() const;

  [[nodiscard]] const std::uint8_t* bytes(std::size_t index) const { return slots_[index].memory; }
  [[nodiscard]] std::size_t size(std::size_t index) const { return slots_[index].length; }
  /// v4l2_buffer's flags at mapping: the kind of time stamp.
  [[nodiscard]] std::uint32_t flags() const { return flags_; }

 private:
  struct Slot {
    std::uint8_t* memory = nullptr;
    std::size_t length = 0;
    bool with_driver = false;
  };
  std::array<Slot, kMax> slots_{};
  std::size_t count_ = 0;
  std::uint32_t flags_ = 0;
};

}  // namespace touchline::hal
