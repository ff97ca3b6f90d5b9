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

/// The buffers of a V4L2 device: mapped, exported as dma-bufs, and owned by the driver or by the loop. Functions return
/// 0 or an errno.
///
/// Requests cached memory if the driver offers it. The kernel then synchronizes the caches whenever a buffer changes
/// its owner; begin_read() and end_read() synchronize them for users of the dma-buf.
class V4l2Buffers {
 public:
  // The kernel's VIDEO_MAX_FRAME.
  static constexpr std::size_t kMax = 32;
  // Memory planes of a picture: at most one per color plane.
  static constexpr std::size_t kMaxPlanes = touchline::kMaxPlanes;

  /// A filled buffer. `begin` and `bytes`: start and length of the picture in each memory plane.
  struct Filled {
    std::size_t index = 0;
    std::array<const std::uint8_t*, kMaxPlanes> begin{};
    std::array<std::uint32_t, kMaxPlanes> bytes{};
    std::uint32_t flags = 0, sequence = 0;
    Instant stamp{};
  };

  /// Requests `count` buffers, maps those that the driver allocates, and exports them if the driver can.
  [[nodiscard]] int map(const V4l2Device& device, bool multi_planar, std::size_t planes, std::size_t count);
  void unmap(const V4l2Device& device) noexcept;
  [[nodiscard]] std::size_t count() const { return count_; }

  /// Queues all buffers.
  [[nodiscard]] int queue_all(const V4l2Device& device);
  /// Queues one buffer; does nothing if it is already queued.
  [[nodiscard]] int queue(const V4l2Device& device, std::size_t index);
  /// Dequeues the oldest filled buffer. EAGAIN: none is filled.
  [[nodiscard]] int dequeue(const V4l2Device& device, Filled& filled);
  /// Marks all buffers as not queued; call it after VIDIOC_STREAMOFF.
  void forget_queue();
  [[nodiscard]] std::size_t queued() const;

  /// Call these before and after the processor reads a buffer.
  [[nodiscard]] int begin_read(std::size_t index) const;
  [[nodiscard]] int end_read(std::size_t index) const;

  [[nodiscard]] std::size_t size(std::size_t index, std::size_t plane) const { return slots_[index].size[plane]; }
  /// Returns a descriptor per memory plane; -1: not exported.
  [[nodiscard]] const DmaBufs& dma_bufs(std::size_t index) const { return slots_[index].dma_bufs; }
  [[nodiscard]] bool exported() const { return exported_; }
  /// Returns the flags of v4l2_buffer from the time of mapping, which contain the type of the time stamps.
  [[nodiscard]] std::uint32_t flags() const { return flags_; }

 private:
  using Planes = std::array<v4l2_plane, kMaxPlanes>;
  struct Slot {
    std::array<std::uint8_t*, kMaxPlanes> memory{};
    std::array<std::size_t, kMaxPlanes> size{};
    DmaBufs dma_bufs = kNoDmaBufs;
    bool with_driver = false;
  };
  void fill_request(v4l2_buffer& buffer, Planes& planes, std::size_t index) const;
  int map_slot(const V4l2Device& device, std::size_t index);
  void export_all(const V4l2Device& device);
  void close_exports();

  std::array<Slot, kMax> slots_{};
  std::size_t count_ = 0, planes_ = 1;
  bool multi_planar_ = false, exported_ = false;
  std::uint32_t flags_ = 0;
};

}  // namespace touchline::hal
