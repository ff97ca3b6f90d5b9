#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/pixel_format.h"

namespace touchline::hal {

/// A plane of a picture in a dma-buf.
struct DmaPlane {
  int file = -1;
  std::size_t offset = 0, length = 0;
};

/// Memory of a picture, written by devices. Unused planes have no file.
struct DmaBuffer {
  std::array<DmaPlane, kMaxPlanes> plane{};
};

/// A DMA heap, whose memory devices can write and the processor can cache. Reading is fast if each read is announced
/// (DmaMapping). Most ARM boards do not cache the memory that V4L2 drivers allocate themselves: each access to a pixel
/// then goes to RAM.
class DmaHeap {
 public:
  DmaHeap() = default;
  DmaHeap(const DmaHeap&) = delete;
  DmaHeap& operator=(const DmaHeap&) = delete;
  ~DmaHeap() { close(); }

  /// 0 or an errno. EACCES: no permission; ENOENT: this system has no heap that cameras can write to.
  [[nodiscard]] int open();
  void close();
  /// Name of the heap that was opened or refused.
  [[nodiscard]] const char* name() const { return name_; }
  /// Allocates a dma-buf, which the caller closes. 0 or an errno.
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

  /// To be called after the device has written and before the first read: the caches are out of date.
  [[nodiscard]] int begin_read() { return synchronize(true); }
  /// To be called before the device writes again. Does nothing without begin_read().
  [[nodiscard]] int end_read() { return synchronize(false); }

  /// Null for unused planes.
  [[nodiscard]] const std::uint8_t* plane(std::size_t index) const { return plane_[index]; }
  /// The mapped files, each once; unused entries are -1.
  [[nodiscard]] std::array<int, kMaxPlanes> files() const {
    return {pieces_[0].file, pieces_[1].file, pieces_[2].file};
  }

 private:
  struct Piece {
    int file = -1;
    void* memory = nullptr;
    std::size_t length = 0;
    bool is_dma = true;  // ordinary shared memory needs no synchronization
    bool reading = false;
  };
  int synchronize(bool begin);
  std::array<Piece, kMaxPlanes> pieces_{};  // one for each file
  std::array<const std::uint8_t*, kMaxPlanes> plane_{};
};

}  // namespace touchline::hal
