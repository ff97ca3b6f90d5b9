#include "hal/linux/dma_buffer.h"

#include <fcntl.h>
#include <linux/dma-buf.h>
#include <linux/dma-heap.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

namespace touchline::hal {
namespace {

// Heaps that every camera device can write to. Heap "system" is left out, because its memory is scattered and needs an
// IOMMU.
constexpr std::array<const char*, 4> kHeaps{
    "/dev/dma_heap/vidbuf_cached",       // Raspberry Pi OS: an alias of the heap that suits the board
    "/dev/dma_heap/default_cma_region",  // contiguous memory; since Linux 6.17
    "/dev/dma_heap/linux,cma",           // the same before Linux 6.17; size from the device tree
    "/dev/dma_heap/reserved"};           // the same; size from the kernel's command line

// Maximum number of attempts; together they take about a millisecond. The loop calls synchronize() with real-time
// priority, and a driver that is never ready must not block it.
constexpr int kMaxTries = 1000;

int synchronize(int dma_buf, unsigned long long flags) {
  dma_buf_sync request{flags};
  for (int tries = 1;; ++tries) {
    if (::ioctl(dma_buf, DMA_BUF_IOCTL_SYNC, &request) == 0) return 0;
    const bool again = errno == EINTR || errno == EAGAIN;  // the kernel's documentation asks to repeat the call
    if (!again || tries == kMaxTries) return errno;
  }
}

/// Returns the index of the first plane that lies in the same file as plane i, because each file is mapped once.
std::size_t first_plane_with_file_of(const DmaBuffer& buffer, std::size_t i) {
  std::size_t first = 0;
  while (buffer.plane[first].file != buffer.plane[i].file) ++first;
  return first;
}

}  // namespace

int begin_cpu_read(int dma_buf) { return synchronize(dma_buf, DMA_BUF_SYNC_START | DMA_BUF_SYNC_READ); }
int end_cpu_read(int dma_buf) { return synchronize(dma_buf, DMA_BUF_SYNC_END | DMA_BUF_SYNC_READ); }

int DmaHeap::open() {
  close();
  int first_error = ENOENT;
  for (const char* const heap : kHeaps) {
    const int file = ::open(heap, O_RDWR | O_CLOEXEC);
    if (file >= 0) {
      file_ = file;
      name_ = heap;
      return 0;
    }
    if (first_error != ENOENT || errno == ENOENT) continue;
    first_error = errno;
    name_ = heap;
  }
  return first_error;
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
    FileMapping& mapping = mappings_[first_plane_with_file_of(buffer, i)];
    mapping.file = plane.file;
    mapping.length = std::max(mapping.length, plane.offset + plane.length);
  }
  for (FileMapping& mapping : mappings_) {
    if (mapping.file < 0) continue;
    void* const memory = ::mmap(nullptr, mapping.length, PROT_READ, MAP_SHARED, mapping.file, 0);
    if (memory == MAP_FAILED) {
      const int error = errno;
      unmap();
      return error;
    }
    mapping.memory = memory;
  }
  for (std::size_t i = 0; i < buffer.plane.size(); ++i) {
    const DmaPlane& plane = buffer.plane[i];
    if (plane.file < 0) continue;
    const FileMapping& mapping = mappings_[first_plane_with_file_of(buffer, i)];
    plane_[i] = static_cast<const std::uint8_t*>(mapping.memory) + plane.offset;
  }
  return 0;
}

void DmaMapping::unmap() {
  for (FileMapping& mapping : mappings_) {
    if (mapping.memory != nullptr) ::munmap(mapping.memory, mapping.length);
    mapping = {};
  }
  plane_ = {};
}

int DmaMapping::synchronize(bool begin) {
  for (FileMapping& mapping : mappings_) {
    if (mapping.file < 0 || !mapping.is_dma || mapping.reading == begin) continue;
    const int error = begin ? begin_cpu_read(mapping.file) : end_cpu_read(mapping.file);
    mapping.is_dma = error != ENOTTY;
    if (error != 0 && mapping.is_dma) return error;
    mapping.reading = begin;
  }
  return 0;
}

}  // namespace touchline::hal
