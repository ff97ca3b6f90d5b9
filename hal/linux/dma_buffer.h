#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/pixel_format.h"

namespace touchline::hal {

// A device writes to a dma-buf past the processor's caches. Between begin_cpu_read() and end_cpu_read()
// (DMA_BUF_IOCTL_SYNC) the processor reads what the device wrote. Both return 0 or an errno. ENOTTY: not a dma-buf;
// EAGAIN, EINTR: the driver refused repeatedly.
[[nodiscard]] int begin_cpu_read(int dma_buf);
[[nodiscard]] int end_cpu_read(int dma_buf);

/// A plane of a picture in a dma-buf.
struct DmaPlane {
  int file = -1;
  std::size_t offset = 0, length = 0;
};

/// Memory of a picture that a device writes. Unused planes have file -1.
struct DmaBuffer {
  std::array<DmaPlane, kMaxPlanes> plane{};
};

/// A DMA heap allocates memory that devices can write and the processor can cache. DmaMapping synchronizes the caches.
/// The buffers that V4L2 drivers allocate are not cached on most ARM boards: each access to a pixel then goes to RAM.
class DmaHeap {
 public:
  DmaHeap() = default;
  DmaHeap(const DmaHeap&) = delete;
  DmaHeap& operator=(const DmaHeap&) = delete;
  ~DmaHeap() { close(); }

  /// Returns 0 or an errno. EACCES: no permission; ENOENT: this system has no heap that cameras can write to.
  [[nodiscard]] int open();
  void close();
  /// Returns the path of the heap that was opened, or that could not be opened.
  [[nodiscard]] const char* name() const { return name_; }
  /// Allocates a dma-buf; the caller closes `file`. Returns 0 or an errno.
  [[nodiscard]] int allocate(std::size_t bytes, int& file) const;

 private:
  int file_ = -1;
  const char* name_ = "";
};

/// Maps the memory of a picture for reading and synchronizes the processor's caches. Errors are errnos.
class DmaMapping {
 public:
  DmaMapping() = default;
  DmaMapping(const DmaMapping&) = delete;
  DmaMapping& operator=(const DmaMapping&) = delete;
  ~DmaMapping() { unmap(); }

  /// The files must stay open until unmap().
  [[nodiscard]] int map(const DmaBuffer& buffer);
  void unmap();

  /// Call it after the device has written and before the first read.
  [[nodiscard]] int begin_read() { return synchronize(true); }
  /// Call it before the device writes again. Does nothing without begin_read().
  [[nodiscard]] int end_read() { return synchronize(false); }

  /// Returns null for unused planes.
  [[nodiscard]] const std::uint8_t* plane(std::size_t index) const { return plane_[index]; }
  /// Returns the mapped files without repetition; unused entries are -1.
  [[nodiscard]] std::array<int, kMaxPlanes> files() const {
    return {mappings_[0].file, mappings_[1].file, mappings_[2].file};
  }

 private:
  struct FileMapping {
    int file = -1;
    void* memory = nullptr;
    std::size_t length = 0;
    bool is_dma = true;  // ordinary shared memory needs no synchronization
    bool reading = false;
  };
  int synchronize(bool begin);
  std::array<FileMapping, kMaxPlanes> mappings_{};  // one per file
  std::array<const std::uint8_t*, kMaxPlanes> plane_{};
};

}  // namespace touchline::hal
