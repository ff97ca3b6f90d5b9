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

/// A picture's memory: what devices write and we read. Unused planes have no file.
struct DmaBuffer {
  std::array<DmaPlane, kMaxPlanes> plane{};
};

/// Memory that devices can write to and that our processor's caches may hold: reading is fast, as long as each reading
/// is announced (DmaMapping). The memory that V4L2 drivers make by themselves is not cached on most ARM boards, and
/// every look at a pixel then goes to the RAM.
class DmaHeap {
 public:
  DmaHeap() = default;
  DmaHeap(const DmaHeap&) = delete;
  DmaHeap& operator=(const DmaHeap&) = delete;
  ~DmaHeap() { close(); }

  /// 0, or an errno: EACCES when a heap may not be used, ENOENT when this system has none that cameras can write to.
  [[nodiscard]] int open();
  void close();
  /// Of the heap that was opened or refused.
  [[nodiscard]] const char* name() const { return name_; }
  /// A dma-buf, to be closed by the caller; 0 or an errno.
  [[nodiscard]] int allocate(std::size_t bytes, int& file) const;

 private:
  int file_ = -1;
  const char* name_ = "";
};

/// A picture's memory, mapped for reading, and the processor's caches kept true to it. Errors are errnos.
class DmaMapping {
 public:
  DmaMapping() = default;
  DmaMapping(const DmaMapping&) = delete;
  DmaMapping& operator=(const DmaMapping&) = delete;
  ~DmaMapping() { unmap(); }

  /// The files must stay open while it is mapped.
  [[nodiscard]] int map(const DmaBuffer& buffer);
  void unmap();

  /// To be called after the device has written and before the first look: what the caches hold is out of date.
  [[nodiscard]] int begin_read() { return synchronize(true); }
  /// To be called before the device writes again; without begin_read() nothing happens.
  [[nodiscard]] int end_read() { return synchronize(false); }

  /// Null for a plane that the buffer has not.
  [[nodiscard]] const std::uint8_t* plane(std::size_t index) const { return plane_[index]; }
  /// The files that were mapped, each once; -1: fewer.
  [[nodiscard]] std::array<int, kMaxPlanes> files() const {
    return {pieces_[0].file, pieces_[1].file, pieces_[2].file};
  }

 private:
  struct Piece {
    int file = -1;
    void* memory = nullptr;
    std::size_t length = 0;
    bool is_dma = true;  // ordinary shared memory needs no care
    bool reading = false;
  };
  int synchronize(bool begin);
  std::array<Piece, kMaxPlanes> pieces_{};  // one for each file
  std::array<const std::uint8_t*, kMaxPlanes> plane_{};
};

}  // namespace touchline::hal
