#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/time.h"
#include "hal/camera.h"
#include "hal/linux/v4l2/v4l2_device.h"

struct v4l2_buffer;
struct v4l2_plane;

namespace touchline::hal {

/// The driver's buffers, mapped into our memory and exported as dma-bufs, and who has each: the driver or the loop.
/// Errors are errnos.
///
/// Memory is asked for that the processor caches, where the driver has a choice; the kernel then looks after the caches
/// whenever a buffer changes hands, and begin_read() and end_read() do so for those who share the dma-buf.
class V4l2Buffers {
 public:
  // VIDEO_MAX_FRAME of the kernel.
  static constexpr std::size_t kMax = 32;
  // Pieces of memory of one picture: one for each plane.
  static constexpr std::size_t kMaxPlanes = touchline::kMaxPlanes;

  /// A filled buffer. `begin`: where the picture begins in each piece of memory, and how many bytes it has there.
  struct Filled {
    std::size_t index = 0;
    std::array<const std::uint8_t*, kMaxPlanes> begin{};
    std::array<std::uint32_t, kMaxPlanes> bytes{};
    std::uint32_t flags = 0, sequence = 0;
    Instant stamp{};
  };

  /// Asks for `count` and maps what is granted; then exports it, if the driver can.
  [[nodiscard]] int map(const V4l2Device& device, bool multi_planar, std::size_t planes, std::size_t count);
  void unmap(const V4l2Device& device) noexcept;
  [[nodiscard]] std::size_t count() const { return count_; }

  /// Hands all buffers to the driver.
  [[nodiscard]] int queue_all(const V4l2Device& device);
  /// Hands one back; nothing happens when the driver has it already.
  [[nodiscard]] int queue(const V4l2Device& device, std::size_t index);
  /// Takes the oldest filled one. EAGAIN: none is filled.
  [[nodiscard]] int dequeue(const V4l2Device& device, Filled& filled);
  /// After the end of streaming the driver holds none.
  void forget_queue();
  [[nodiscard]] std::size_t queued() const;

  /// Around the processor's reading of a buffer.
  [[nodiscard]] int begin_read(std::size_t index) const;
  [[nodiscard]] int end_read(std::size_t index) const;

  [[nodiscard]] std::size_t size(std::size_t index, std::size_t plane) const { return slots_[index].size[plane]; }
  /// One a piece of memory, -1: not exported.
  [[nodiscard]] const DmaBufs& dma_bufs(std::size_t index) const { return slots_[index].dma_bufs; }
  [[nodiscard]] bool exported() const { return exported_; }
  /// v4l2_buffer's flags at mapping: the kind of time stamp.
  [[nodiscard]] std::uint32_t flags() const { return flags_; }

 private:
  using Planes = std::array<v4l2_plane, kMaxPlanes>;
  struct Slot {
    std::array<std::uint8_t*, kMaxPlanes> memory{};
    std::array<std::size_t, kMaxPlanes> size{};
    DmaBufs dma_bufs = kNotShared;
    bool with_driver = false;
  };
  void address(v4l2_buffer& buffer, Planes& planes, std::size_t index) const;
  int map_slot(const V4l2Device& device, std::size_t index);
  void export_all(const V4l2Device& device);
  void close_exports();

  std::array<Slot, kMax> slots_{};
  std::size_t count_ = 0, planes_ = 1;
  bool multi_planar_ = false, exported_ = false;
  std::uint32_t flags_ = 0;
};

}  // namespace touchline::hal
