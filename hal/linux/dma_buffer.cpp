#include "hal/linux/dma_buffer.h"

#include <fcntl.h>
#include <linux/dma-heap.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

#include "hal/linux/dma_buf.h"

namespace touchline::hal {
namespace {

// Only heaps that every camera device can write to: the memory of heap "system" is scattered and needs an IOMMU.
constexpr std::array<const char*, 4> kHeaps{
    "/dev/dma_heap/vidbuf_cached",       // Raspberry Pi OS: an alias of the heap that suits the board
    "/dev/dma_heap/default_cma_region",  // contiguous memory; since Linux 6.17
    "/dev/dma_heap/linux,cma",           // the same before Linux 6.17; size from the device tree
    "/dev/dma_heap/reserved"};           // the same; size from the kernel's command line

/// The first plane with the file of plane i: each file is mapped once.
std::size_t piece_of(const DmaBuffer& buffer, std::size_t i) {
  std::size_t first = 0;
  while (buffer.plane[first].file != buffer.plane[i].file) ++first;
  return first;
}

}  // namespace

int DmaHeap::open() {
  close();
  int told = ENOENT;
  for (const char* const heap : kHeaps) {
    const int file = ::open(heap, O_RDWR | O_CLOEXEC);
    if (file >= 0) {
      file_ = file;
      name_ = heap;
      return 0;
    }
    if (told != ENOENT || errno == ENOENT) continue;
    told = errno;
    name_ = heap;
  }
  return told;
}

void DmaHeap::close() {
  if (file_ >= 0) ::close(file_);
  file_ = -1;
  name_ = "";
}

int DmaHeap::allocate(std::size_t bytes, int& file) const {
  dma_heap_allocation_data request{};
  request.len = bytes;
  request.fd_flags = O_RDWR | O_CLOEXEC;
  int result = 0;
  do {
    result = ::ioctl(file_, DMA_HEAP_IOCTL_ALLOC, &request);
  } while (result < 0 && errno == EINTR);
  if (result < 0) return errno;
  file = static_cast<int>(request.fd);
  return 0;
}

int DmaMapping::map(const DmaBuffer& buffer) {
  unmap();
  for (std::size_t i = 0; i < buffer.plane.size(); ++i) {
    const DmaPlane& plane = buffer.plane[i];
    if (plane.file < 0) continue;
    Piece& piece = pieces_[piece_of(buffer, i)];
    piece.file = plane.file;
    piece.length = std::max(piece.length, plane.offset + plane.length);
  }
  for (Piece& piece : pieces_) {
    if (piece.file < 0) continue;
    void* const memory = ::mmap(nullptr, piece.length, PROT_READ, MAP_SHARED, piece.file, 0);
    if (memory == MAP_FAILED) {
      const int error = errno;
      unmap();
      return error;
    }
    piece.memory = memory;
  }
  for (std::size_t i = 0; i < buffer.plane.size(); ++i) {
    const DmaPlane& plane = buffer.plane[i];
    if (plane.file < 0) continue;
    const Piece& piece = pieces_[piece_of(buffer, i)];
    plane_[i] = static_cast<const std::uint8_t*>(piece.memory) + plane.offset;
  }
  return 0;
}

void DmaMapping::unmap() {
  for (Piece& piece : pieces_) {
    if (piece.memory != nullptr) ::munmap(piece.memory, piece.length);
    piece = {};
  }
  plane_ = {};
}

int DmaMapping::synchronize(bool begin) {
  for (Piece& piece : pieces_) {
    if (piece.file < 0 || !piece.is_dma || piece.reading == begin) continue;
    const int error = begin ? begin_cpu_read(piece.file) : end_cpu_read(piece.file);
    piece.is_dma = error != ENOTTY;
    if (error != 0 && piece.is_dma) return error;
    piece.reading = begin;
  }
  return 0;
}

}  // namespace touchline::hal
